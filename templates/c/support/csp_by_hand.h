/* SPDX-License-Identifier: 0BSD */
/* Compile-time checks of hand-written headers. To be included after them. */
#ifndef CSP_BY_HAND_H
#define CSP_BY_HAND_H

#undef _Static_assert /* a macro of the library, without the message */

#if defined(__GNUC__)
#define CSP_HAS_TYPE(expression, type) __builtin_types_compatible_p(__typeof__(expression), type)
#define CSP_REQUIRE(condition, name, message) __extension__ _Static_assert(condition, message)
#elif defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)
#define CSP_HAS_TYPE(expression, type) _Generic((expression), type : 1, default : 0)
#define CSP_REQUIRE(condition, name, message) _Static_assert(condition, message)
#else
/* Plain C99 can compare types only by size, and shows no message but the name. */
#define CSP_HAS_TYPE(expression, type) (sizeof(expression) == sizeof(type))
#define CSP_REQUIRE(condition, name, message) typedef char name[(condition) ? 1 : -1]
#endif

/* The function must have the result and the parameters, which are in parentheses. By their size all functions are alike. */
#define CSP_REQUIRE_FUNCTION(result, function, parameters, name, message)                                              \
    CSP_REQUIRE(CSP_HAS_TYPE(&(function), result(*) parameters), name, message)

/* The member of a struct must have the type. Compilers that show no message show `name`. */
#define CSP_REQUIRE_MEMBER(structure, member, type, name, message)                                                     \
    CSP_REQUIRE(CSP_HAS_TYPE(((structure *)0)->member, type), name, message)

/* The same for an array of `count` elements of the type. */
#define CSP_REQUIRE_ARRAY(structure, member, type, count, name, message)                                               \
    CSP_REQUIRE(CSP_HAS_TYPE(((structure *)0)->member[0], type) &&                                                     \
                    (sizeof(((structure *)0)->member) == ((count) * sizeof(type))),                                    \
                name, message)

#endif
