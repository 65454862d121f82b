/// What nearly every file of the tools includes, parsed once for all of them. A file still includes what it
/// uses.
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

#include "ocm/protocol/codec.hpp"
#include "ocm/transport/bus.hpp"
