/// A callable kept inside the object: what std::function would be without a heap. The callable must be
/// trivially copyable and fit into `Capacity` bytes (two pointers unless told), which a lambda that captures
/// one or two references does; anything larger does not compile.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>

namespace ocm::base {

template <class Signature, std::size_t Capacity = 2 * sizeof(void*)>
class InlineFunction;

template <class R, class... Args, std::size_t Capacity>
class InlineFunction<R(Args...), Capacity> {
 public:
  constexpr InlineFunction() = default;

  template <class F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, InlineFunction> && std::is_invocable_r_v<R, F&, Args...>)
      InlineFunction(F callable)
  noexcept {  // NOLINT: a callable is a function
    static_assert(sizeof(F) <= Capacity, "capture less: the callable does not fit into its place");
    static_assert(alignof(F) <= alignof(void*), "the callable needs a stricter alignment than a pointer");
    static_assert(std::is_trivially_copyable_v<F>, "capture references or plain values only");
    ::new (static_cast<void*>(place_)) F(std::move(callable));
    call_ = [](void* place, Args... args) -> R {
      return (*std::launder(reinterpret_cast<F*>(place)))(static_cast<Args&&>(args)...);
    };
  }

  explicit operator bool() const noexcept { return call_ != nullptr; }
  /// Undefined for an empty function: test first.
  R operator()(Args... args) { return call_(place_, static_cast<Args&&>(args)...); }

 private:
  R (*call_)(void*, Args...) = nullptr;
  alignas(void*) std::byte place_[Capacity]{};
};

}  // namespace ocm::base
