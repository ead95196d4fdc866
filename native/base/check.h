// SPDX-License-Identifier: GPL-3.0-or-later
// Invariants: a failed check throws InternalError with both values; it never aborts (Blender must
// survive).
#pragma once

#include <sstream>

#include "base/error.h"

namespace granita::detail {

[[noreturn]] inline void check_failed(const char* file, int line, const std::string& what) {
    std::ostringstream message;
    message << "internal error at " << file << ":" << line << ": " << what;
    throw InternalError(message.str());
}

template <class A, class B>
std::string compare_text(const char* text, const A& a, const B& b) {
    std::ostringstream message;
    message << text << " (" << a << " against " << b << ")";
    return message.str();
}

}  // namespace granita::detail

#define GRANITA_CHECK(condition)                                                           \
    do {                                                                                   \
        if (!(condition)) ::granita::detail::check_failed(__FILE__, __LINE__, #condition); \
    } while (false)

#define GRANITA_CHECK_OP(a, op, b)                                                     \
    do {                                                                               \
        const auto& check_a = (a);                                                     \
        const auto& check_b = (b);                                                     \
        if (!(check_a op check_b))                                                     \
            ::granita::detail::check_failed(                                           \
                __FILE__, __LINE__,                                                    \
                ::granita::detail::compare_text(#a " " #op " " #b, check_a, check_b)); \
    } while (false)

#define GRANITA_CHECK_EQ(a, b) GRANITA_CHECK_OP(a, ==, b)
#define GRANITA_CHECK_LT(a, b) GRANITA_CHECK_OP(a, <, b)
#define GRANITA_CHECK_LE(a, b) GRANITA_CHECK_OP(a, <=, b)
#define GRANITA_CHECK_GE(a, b) GRANITA_CHECK_OP(a, >=, b)

#ifdef NDEBUG
#define GRANITA_DCHECK(condition) \
    do {                          \
    } while (false)
#else
#define GRANITA_DCHECK(condition) GRANITA_CHECK(condition)
#endif
