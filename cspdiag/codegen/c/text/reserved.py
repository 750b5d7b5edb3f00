"""Names that C, C++, their libraries and POSIX have already."""

from __future__ import annotations

import re

from cspdiag.codegen.shared.names import words

_KEYWORDS = words(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    bool true false NULL main self asm fortran typeof near far huge interrupt linux unix i386

    alignas alignof and and_eq bitand bitor catch char8_t char16_t char32_t class co_await co_return co_yield compl
    concept const_cast consteval constexpr constinit decltype delete dynamic_cast explicit export friend mutable
    namespace new noexcept not not_eq nullptr operator or or_eq private protected public reinterpret_cast requires
    static_assert static_cast template this thread_local throw try typeid typename typeof_unqual using virtual wchar_t
    xor xor_eq
    """
)
"""Keywords of C, and of C++, in which a user may include the interface; and what compilers have built in."""

MATHEMATICS = words(
    """
    acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh drem erf erfc exp exp10 exp2 expm1 fabs fdim
    finite floor fma fmax fmin fmod frexp gamma hypot ilogb isinf isnan j0 j1 jn ldexp lgamma llrint llround log log10
    log1p log2 logb lrint lround modf nan nearbyint nextafter nexttoward pow pow10 remainder remquo rint round
    roundeven scalb scalbln scalbn significand sin sincos sinh sqrt tan tanh tgamma trunc y0 y1 yn
    """
)
"""Functions of math.h, each of which exists for `float` (``sinf``) and `long double` (``sinl``), too."""

_LIBRARY = words(
    """
    abs fpclassify infinity isfinite isgreater isgreaterequal isless islessequal islessgreater isnormal isunordered
    lgamma_r lgammaf_r lgammal_r math_errhandling signbit signgam
    abort assert atexit atof atoi atol atoll bcmp bcopy bsearch bzero calloc clock difftime div errno exit
    explicit_bzero fclose feof fflush ffs ffsl ffsll fopen fprintf fread free fputs fwrite getc getchar getenv index
    labs ldiv llabs lldiv localtime longjmp malloc memccpy memchr memcmp memcpy memmove memset mktime offsetof perror
    printf putc putchar puts qsort raise rand realloc remove rename rewind rindex scanf setjmp signal snprintf sprintf
    srand stderr stdin stdout stpcpy stpncpy strcasecmp strcasecmp_l strcat strchr strcmp strcoll strcoll_l strcpy
    strcspn strdup strerror strerror_l strerror_r strlen strncasecmp strncasecmp_l strncat strncmp strncpy strndup
    strnlen strpbrk strrchr strsep strsignal strspn strstr strtod strtof strtok strtok_r strtol strtold strtoll strtoul
    strtoull strxfrm strxfrm_l system time tmpfile toupper tolower ungetc vprintf
    accept alarm bind brk close connect creat dup environ exec execl execv fork getpid kill link listen lseek nice open
    pause pipe poll read recv select send shutdown sleep socket stat sync times truncate unlink usleep wait write yield
    double_t float_t locale_t max_align_t ptrdiff_t size_t ssize_t
    """
)
"""Names of the library of C and of POSIX that are built into compilers, or that headers declare."""

_PATTERN = re.compile(
    r"""
    u?int(_fast|_least)?\d+_t | u?int(max|ptr)_t
    | U?INT(_FAST|_LEAST)?\d*_(C|MAX|MIN|WIDTH) | U?INT(MAX|PTR)_(C|MAX|MIN|WIDTH)
    | (S|U)?CHAR_(MAX|MIN|BIT) | U?(SHRT|LONG|LLONG)_(MAX|MIN) | SSIZE_(MAX|WIDTH) | RAND_MAX
    | (SIZE|PTRDIFF|WCHAR|WINT|SIG_ATOMIC)_(MAX|MIN|WIDTH)
    | (FP|M|HUGE|MATH|FLT|DBL|LDBL|EXIT)_[A-Z0-9_]+
    | [A-Z0-9_]+_H
    | EOF | INFINITY | NAN | NULL | DOMAIN | OVERFLOW | UNDERFLOW | SING | PLOSS | TLOSS | HUGE | MAXFLOAT | I | BUFSIZ
    """,
    re.VERBOSE,
)
"""Types of integers, and macros of headers, with those that keep a header from being included twice."""


def is_reserved(name: str) -> bool:
    """Whether C or C++ gives the name a meaning of its own."""
    return (
        name in _KEYWORDS or name in _LIBRARY or name in MATHEMATICS or (name[:-1] in MATHEMATICS and name[-1] in "fl")
        or _PATTERN.fullmatch(name) is not None
    )  # fmt: skip
