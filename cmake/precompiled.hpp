/// What nearly every file of the tools includes, parsed once for all of them. A file still includes what it
/// uses. No header of ours: a change would compile everything again, and a cache of compiled files, which
/// does not look at comments, would give a compiled header that g++ does not take for the one that it reads.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <fmt/format.h>
