/* SPDX-License-Identifier: 0BSD */
/* Variables that the run shares with other threads, or with interrupt and signal handlers. */
#ifndef CSP_SHARED_H
#define CSP_SHARED_H

#if defined(__GNUC__) && (__GCC_ATOMIC_INT_LOCK_FREE == 2)
#define CSP_LOAD(variable) __atomic_load_n(&(variable), __ATOMIC_SEQ_CST)
#define CSP_STORE(variable, value) __atomic_store_n(&(variable), (value), __ATOMIC_SEQ_CST)
/* A store with release order, for observers in other threads. */
#define CSP_STORE_AFTER(variable, value) __atomic_store_n(&(variable), (value), __ATOMIC_RELEASE)
#define CSP_NOTE(variable, value) __atomic_store_n(&(variable), (value), __ATOMIC_RELAXED)
/* Adds 1, and returns the previous value. */
#define CSP_COUNT(variable) __atomic_fetch_add(&(variable), 1U, __ATOMIC_SEQ_CST)
#else /* one processor without threads: volatile is enough */
#define CSP_LOAD(variable) (variable)
#define CSP_STORE(variable, value) ((variable) = (value))
#define CSP_STORE_AFTER(variable, value) ((variable) = (value))
#define CSP_NOTE(variable, value) ((variable) = (value))
#define CSP_COUNT(variable) ((variable)++)
#endif

#endif
