/// Ctrl-C and SIGTERM end a command cleanly: they interrupt a wait, and the verb sees here that it is over.
#pragma once

namespace ocm::cli {

/// From now on SIGINT and SIGTERM are noted instead of killing.
void catch_interrupts();
/// SIGHUP (the terminal is closed) and SIGQUIT too, for a verb that has something to finish. A signal that
/// is ignored (nohup) stays so.
void catch_hangups();
/// The signal that came, or 0.
[[nodiscard]] int interrupted() noexcept;
/// 128 + signal when one came, else `code`.
[[nodiscard]] int exit_code_after_interrupt(int code) noexcept;

}  // namespace ocm::cli
