"""What of the standard library our headers use, and the headers that bring it. A name in two lines is in either."""
import re

_NAMES = """
algorithm: all_of any_of clamp copy copy_n count_if equal erase_if fill fill_n find find_if lower_bound max min min_element
    none_of nth_element reverse rotate sort stable_sort unique upper_bound
array: array begin end get swap tuple_size
atomic: atomic memory_order_acquire memory_order_relaxed memory_order_release
bit: bit_cast bit_ceil countl_zero countr_zero endian
charconv: from_chars to_chars
chrono: chrono chrono_literals nano
cmath: abs atan2 ceil cos exp floor fmod hypot isnan llround lround pow remainder sin sqrt
concepts: convertible_to destructible integral invocable predicate same_as
cstddef: byte ptrdiff_t size_t
cstdint: int16_t int32_t int64_t int8_t uint16_t uint32_t uint64_t uint8_t uintptr_t
cstdlib: abs getenv size_t
cstring: memchr memcmp memcpy memmove memset size_t strerror
ctime: size_t time_t tm
deque: begin deque end erase_if
filesystem: filesystem
functional: function greater
limits: numeric_limits
map: begin end erase_if map multimap
memory: make_unique unique_ptr
new: launder
numbers: numbers
numeric: gcd
optional: nullopt nullopt_t optional
queue: priority_queue
random: mt19937_64 seed_seq
span: begin end span
string: begin end erase_if string to_string
string_view: begin end string_view
system_error: errc error_code generic_category
tuple: get tuple
type_traits: conditional_t is_enum_v is_floating_point_v is_integral_v is_invocable_r_v is_invocable_v is_same_v is_signed_v is_trivially_copyable_v
    is_unsigned_v is_void_v make_signed_t remove_cvref_t
utility: as_const declval exchange forward get index_sequence index_sequence_for make_index_sequence move pair swap
vector: begin end erase_if vector
"""

# Header -> the names that it brings.
HEADERS = {header: names.split() for header, names in re.findall(r"^(\w+): ((?:.|\n )*)$", _NAMES, re.MULTILINE)}
# Name -> the headers that bring it.
BROUGHT_BY = {}
for _header, _names in HEADERS.items():
    for _name in _names:
        BROUGHT_BY.setdefault(_name, set()).add(_header)

# What `std::size_t` and its like mean: a name, or a namespace of a header.
USE = re.compile(r"\bstd::([a-z]\w*)")
