/* From the ids of a file to indices.
 *
 * Most files number 1, 2, 3, ...: then a plain table answers. Where the ids have large gaps the
 * map falls back to a sorted list, so that one node called 4000000000 costs no gigabytes.
 */
#ifndef LAR_MODEL_MESH_ID_MAP_H
#define LAR_MODEL_MESH_ID_MAP_H

#include <stdint.h>

#include "base/memory.h"

typedef struct lar_id_pair {
    int64_t id;
    int32_t index;
} lar_id_pair;

typedef struct lar_id_map {
    int32_t count;
    int64_t first;     /* smallest id */
    uint64_t span;     /* length of table, 0 when the pairs are used */
    int32_t *table;    /* index of id first + i, or -1 */
    lar_id_pair *pair; /* ascending ids */
} lar_id_map;

/* What lar_id_map_build found: two indices with the same id; -1 when all differ. */
typedef struct lar_id_clash {
    int32_t first, second;
} lar_id_clash;

/* Builds the map of ids[0..count-1], read with a stride of `stride` bytes. False when memory is
 * refused. With a clash the map holds the first of the two. Clear with lar_id_map_clear. */
bool lar_id_map_build(lar_id_map *map, const int64_t *ids, int32_t count, size_t stride,
                      lar_id_clash *clash);
void lar_id_map_clear(lar_id_map *map);

/* Index of the id, -1 when there is none. */
int32_t lar_id_map_find(const lar_id_map *map, int64_t id);

#endif
