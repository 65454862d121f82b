// Two tasks that claim two buses inside each other, in two orders: under priority inheritance they can wait
// for ever.
// expect: the_table_of_sections_is_not_good
#include "ocm/analysis/blocking.hpp"

using namespace ocm::analysis;

inline constexpr std::uint32_t i2c = 1;
inline constexpr std::uint32_t spi = 2;
inline constexpr auto tasks = in_order(std::array{Task{10, 100}, Task{20, 200}});

#ifdef OCM_MUST_FAIL
inline constexpr std::array sections{Section{0, i2c, 5}, Section{0, spi, 4, 0}, Section{1, spi, 5},
                                     Section{1, i2c, 4, 2}};
#else
inline constexpr std::array sections{Section{0, i2c, 5}, Section{0, spi, 4, 0}, Section{1, i2c, 5},
                                     Section{1, spi, 4, 2}};
#endif
inline constexpr auto blocked = with_blocking(tasks, sections, Protocol::inheritance);
static_assert(blocked[0].blocking == 5);
