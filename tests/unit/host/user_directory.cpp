#include "ocm/host/user_directory.hpp"

#include <catch2/catch.hpp>

#include "unit/host/host_testing.hpp"

namespace host_user_directory_test {

using namespace ocm;
using namespace ocm::test;

TEST_CASE("the directory lies in the user's runtime directory, or else in /tmp") {
  const TemporaryDirectory directory;
  {
    const Environment set{"XDG_RUNTIME_DIR", directory.path().c_str()};
    CHECK(host::user_directory() == directory.path() + "/ocm");
  }
  for (const char* value :
       {static_cast<const char*>(nullptr), "", "relative", "/nowhere/at/all", "/dev/null"}) {
    const Environment set{"XDG_RUNTIME_DIR", value};
    CHECK(host::user_directory() == "/tmp/ocm-" + std::to_string(::geteuid()));
  }
}

TEST_CASE("only a directory that is ours and closed to others is trusted") {
  const TemporaryDirectory parent;
  const std::string directory = parent.path() + "/ocm";
  CHECK_THAT(host::check_private(directory)->what,
             Catch::Contains(directory) && Catch::Contains("No such file"));
  REQUIRE(::mkdir(directory.c_str(), 0700) == 0);
  CHECK_FALSE(host::check_private(directory));
  for (const mode_t mode : {0701U, 0720U, 0777U}) {
    REQUIRE(::chmod(directory.c_str(), mode) == 0);
    const auto problem = host::check_private(directory);
    REQUIRE(problem);
    CHECK_THAT(problem->what, Catch::Contains("open to other users"));
    CHECK(problem->remedy == "chmod 700 " + directory);
  }
  const std::string link = parent.path() + "/link";
  REQUIRE(::symlink(directory.c_str(), link.c_str()) == 0);
  CHECK_THAT(host::check_private(link)->what, Catch::Contains("is not a directory"));
  if (::geteuid() == 0) {  // only root can give a directory away
    REQUIRE(::chmod(directory.c_str(), 0700) == 0);
    REQUIRE(::chown(directory.c_str(), 65534, 65534) == 0);
    CHECK_THAT(host::check_private(directory)->what, Catch::Contains("another user (uid 65534)"));
  }
}

}  // namespace host_user_directory_test
