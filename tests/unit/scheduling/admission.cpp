#include "ocm/scheduling/admission.hpp"

#include <type_traits>

#include <catch2/catch.hpp>

namespace scheduling_admission_test {

using namespace ocm;
using namespace ocm::scheduling;
using namespace std::chrono_literals;

static_assert(Admission<AdmitAll>);
static_assert(std::is_empty_v<AdmitAll>);

struct Forgetful {
  base::Error admit(std::size_t, base::Duration, Level) { return base::Error::none; }
};
static_assert(!Admission<Forgetful>);
struct Yes {
  bool admit(std::size_t, base::Duration, Level) { return true; }
  void ended(std::size_t) {}
};
static_assert(!Admission<Yes>);

TEST_CASE("AdmitAll takes everything") {
  CHECK(AdmitAll::admit(0, base::Duration{1}, Level::urgent) == base::Error::none);
  AdmitAll::ended(0);
}

}  // namespace scheduling_admission_test
