/* SPDX-License-Identifier: 0BSD */
/* Copies of a state without pointers, which another process or another instance can continue from.
 *
 * A generated table says where the pointers of a structure are. In a copy, a pointer is its distance from the beginning of the memory that it points into, which
 * is either that of the instance or the image of the program: its functions, tables and texts.
 */
#ifndef CSP_SAVED_H
#define CSP_SAVED_H

#include <stddef.h>
#include <stdint.h>

#include "csp_config.h"

typedef struct csp_pointers csp_pointers;

/* A member that is a pointer or has pointers inside, or an array of them. */
typedef struct csp_pointer_member {
    uint32_t offset;            /* in the structure */
    uint32_t count;             /* of elements; an array may have none */
    uint32_t stride;            /* from one element to the next */
    const csp_pointers *inside; /* the pointers of an element; NULL: it is one */
} csp_pointer_member;

/* The pointers of a structure. */
struct csp_pointers {
    const csp_pointer_member *members;
    uint32_t count;
};

/* The bytes of a member of a structure, or of an element of one; and how many elements there are, which are also those of arrays in arrays. Elements may
 * be structures of nothing but arrays without elements, which take no bytes. */
#define CSP_SIZE_OF(structure, member) (sizeof(((structure *)NULL)->member))
#define CSP_ELEMENTS(structure, member, element) (CSP_SIZE_OF(structure, member) / ((CSP_SIZE_OF(structure, element) != 0U) ? CSP_SIZE_OF(structure, element) : 1U))

/* How far a structure has been gone through. One is needed for each level of structures inside each other. */
typedef struct csp_pointer_visit {
    char *at;
    const csp_pointers *structure;
    uint32_t member;
    uint32_t element;
} csp_pointer_visit;

/* What pointers point into. */
typedef struct csp_saved_places {
    const void *memory; /* of the instance, */
    size_t size;
    const void *image;  /* and any constant of the program */
} csp_saved_places;

/* Makes distances of the pointers of a copy, and pointers of the distances. `visits` is as deep as structures are inside each other. */
void csp_save_pointers(void *copy, const csp_pointers *pointers, csp_pointer_visit *visits, csp_saved_places places);
void csp_restore_pointers(void *copy, const csp_pointers *pointers, csp_pointer_visit *visits, csp_saved_places places);

/* Any function of the program. */
typedef void csp_function(void);

/* The checksum FNV-1a of bytes, continued from the one of the bytes before. */
#define CSP_CHECKSUM_BEGIN UINT32_C(2166136261)
uint32_t csp_checksum(uint32_t before, const void *bytes, size_t size);

#endif
