/* SPDX-License-Identifier: 0BSD */
/* Copies of a state without pointers. */
#include "csp_saved.h"

#include <string.h>

/* Distances from the image begin here, and those from the memory of the instance at 1; 0 is NULL. */
#define IMAGE ((UINTPTR_MAX >> 1U) + 1U)

typedef uintptr_t conversion(uintptr_t value, const csp_saved_places *places);

static uintptr_t distance_of(uintptr_t pointer, const csp_saved_places *places)
{
    const uintptr_t inside = pointer - (uintptr_t)places->memory;
    if (pointer == 0U) {
        return 0U;
    }
    return (inside < places->size) ? (inside + 1U) : ((pointer - (uintptr_t)places->image) + IMAGE);
}

static uintptr_t pointer_of(uintptr_t distance, const csp_saved_places *places)
{
    if (distance == 0U) {
        return 0U;
    }
    return (distance <= places->size) ? ((distance - 1U) + (uintptr_t)places->memory) : ((distance - IMAGE) + (uintptr_t)places->image);
}

static void convert(char *at, conversion *converted, const csp_saved_places *places)
{
    uintptr_t value = 0U;
    (void)memcpy(&value, at, sizeof value);
    value = converted(value, places);
    (void)memcpy(at, &value, sizeof value);
}

static void convert_all(void *memory, const csp_pointers *pointers, csp_pointer_visit *visits, conversion *converted, const csp_saved_places *places)
{
    size_t depth = 0U;
    visits[0] = (csp_pointer_visit){memory, pointers, 0U, 0U};
    for (;;) {
        csp_pointer_visit *const visit = &visits[depth];
        if (visit->member == visit->structure->count) {
            if (depth == 0U) {
                break;
            }
            depth--;
        } else {
            const csp_pointer_member *const member = &visit->structure->members[visit->member];
            char *const at = visit->at + member->offset + ((size_t)visit->element * member->stride);
            if (visit->element == member->count) {
                visit->element = 0U;
                visit->member++;
            } else {
                visit->element++;
                if (member->inside == NULL) {
                    convert(at, converted, places);
                } else {
                    depth++;
                    visits[depth] = (csp_pointer_visit){at, member->inside, 0U, 0U};
                }
            }
        }
    }
}

void csp_save_pointers(void *copy, const csp_pointers *pointers, csp_pointer_visit *visits, csp_saved_places places)
{
    convert_all(copy, pointers, visits, distance_of, &places);
}

void csp_restore_pointers(void *copy, const csp_pointers *pointers, csp_pointer_visit *visits, csp_saved_places places)
{
    convert_all(copy, pointers, visits, pointer_of, &places);
}

uint32_t csp_checksum(uint32_t before, const void *bytes, size_t size)
{
    const unsigned char *const from = bytes;
    uint32_t sum = before;
    for (size_t at = 0U; at < size; at++) {
        sum = (sum ^ from[at]) * UINT32_C(16777619);
    }
    return sum;
}
