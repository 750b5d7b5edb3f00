/* What must hold of headers that are written by hand: checked when they are compiled. To be included after them. */
#ifndef CSP_BY_HAND_H
#define CSP_BY_HAND_H

#undef _Static_assert /* the library's, which has no words */

#if defined(__GNUC__)
#define CSP_HAS_TYPE(expression, type) __builtin_types_compatible_p(__typeof__(expression), type)
#define CSP_REQUIRE(condition, name, message) __extension__ _Static_assert(condition, message)
#elif defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)
#define CSP_HAS_TYPE(expression, type) _Generic((expression), type : 1, default : 0)
#define CSP_REQUIRE(condition, name, message) _Static_assert(condition, message)
#else
/* C99 alone can tell types apart by their sizes only, and has no words but names. */
#define CSP_HAS_TYPE(expression, type) (sizeof(expression) == sizeof(type))
#define CSP_REQUIRE(condition, name, message) typedef char name[(condition) ? 1 : -1]
#endif

/* The member of a struct has the type. `name` says so for compilers that show no message. */
#define CSP_REQUIRE_MEMBER(structure, member, type, name, message)                                                     \
    CSP_REQUIRE(CSP_HAS_TYPE(((structure *)0)->member, type), name, message)

#endif
