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

_HEADERS_OF_C = words(
    """
    aio aliases alloca ar argp argz assert byteswap complex cpio crypt ctype cxxabi devctl dirent dlfcn elf endian
    envlock envz err errno error execinfo fastmath fcntl features fenv float fmtmsg fnmatch fpu_control fstab fts
    ftw gconv getopt glob grp gshadow iconv ieee754 ieeefp ifaddrs inttypes iso646 langinfo lastlog libgen libintl
    limits link locale malloc math mcheck memory mntent monetary mqueue ndbm netdb newlib nl_types nss obstack paths
    picolibc picotls poll printf proc_service pthread pty pwd re_comp reent regdef regex regexp resolv sched search
    semaphore semihost setjmp sgtty shadow signal spawn stab stdalign stdarg stdatomic stdbit stdbool stdckdint
    stddef stdint stdio stdio_ext stdlib stdnoreturn string strings stropts syscall sysexits syslog tar termio
    termios tgmath thread_db threads time ttyent uchar ucontext ulimit unctrl unistd utime utmp utmpx values wait
    wchar wctype wordexp

    acc_prof altivec arm64intr arm_acle arm_bf16 arm_cde arm_cmse arm_fp16 arm_mve arm_mve_types arm_neon arm_sve
    armintr backtrace builtins cet cpuid gcov hexagon_protos hexagon_types hvx_hexagon_protos mm3dnow mm_malloc msa
    omp openacc quadmath quadmath_weak riscv_vector stdfix syslimits unwind vadefs varargs wasm_simd128
    """
)
"""Headers that are included without a folder: those of glibc, newlib, picolibc and musl, and those of the folders of
gcc and clang, all in lower case.
"""

_HEADERS_OF_SYSTEMS = words(
    """
    freertos task tasks queue list timers semphr croutine event_groups stream_buffer message_buffer portable
    portmacro projdefs stack_macros mpu_wrappers mpu_prototypes deprecated_definitions atomic sdkconfig arduino
    """
)
"""The same of FreeRTOS, ESP-IDF and Arduino, where programs run."""

_HEADERS_OF_PROCESSORS = re.compile(r"\w*intrin(sics)?")
"""The names of headers that declare the instructions of a processor, of which each compiler has many."""

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


def is_header(name: str) -> bool:
    """Whether C libraries, compilers or common systems have a header of this name (without `.h`), in capitals or not:
    some file systems ignore these.
    """
    return is_header_of_c(name) or name.lower() in _HEADERS_OF_SYSTEMS


def is_header_of_c(name: str) -> bool:
    """The same of C libraries and compilers, which include them themselves."""
    lower = name.lower()
    return lower in _HEADERS_OF_C or _HEADERS_OF_PROCESSORS.fullmatch(lower) is not None
