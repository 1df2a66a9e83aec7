#include "model/mesh/id_map.h"

#include <stdlib.h>
#include <string.h>

static int compare_pairs(const void *a, const void *b) {
    const lar_id_pair *x = a, *y = b;
    if (x->id != y->id) return x->id < y->id ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
}

static int64_t id_at(const int64_t *ids, size_t stride, int32_t i) {
    int64_t id;
    memcpy(&id, (const char *)ids + (size_t)i * stride, sizeof id);
    return id;
}

static bool build_table(lar_id_map *map, const int64_t *ids, size_t stride, lar_id_clash *clash) {
    map->table = malloc((size_t)map->span * sizeof *map->table);
    if (!map->table) return false;
    for (uint64_t i = 0; i < map->span; i++) map->table[i] = -1;
    for (int32_t i = 0; i < map->count; i++) {
        int32_t *slot = &map->table[(uint64_t)id_at(ids, stride, i) - (uint64_t)map->first];
        if (*slot < 0)
            *slot = i;
        else if (clash->second < 0)
            *clash = (lar_id_clash){*slot, i};
    }
    return true;
}

static bool build_pairs(lar_id_map *map, const int64_t *ids, size_t stride, lar_id_clash *clash) {
    map->pair = lar_calloc((size_t)map->count, sizeof *map->pair);
    if (!map->pair) return false;
    for (int32_t i = 0; i < map->count; i++) map->pair[i] = (lar_id_pair){id_at(ids, stride, i), i};
    qsort(map->pair, (size_t)map->count, sizeof *map->pair, compare_pairs);
    for (int32_t i = 1; i < map->count && clash->second < 0; i++)
        if (map->pair[i].id == map->pair[i - 1].id)
            *clash = (lar_id_clash){map->pair[i - 1].index, map->pair[i].index};
    return true;
}

bool lar_id_map_build(lar_id_map *map, const int64_t *ids, int32_t count, size_t stride,
                      lar_id_clash *clash) {
    *map = (lar_id_map){.count = count};
    *clash = (lar_id_clash){-1, -1};
    if (count == 0) return true;

    int64_t smallest = id_at(ids, stride, 0), largest = smallest;
    for (int32_t i = 1; i < count; i++) {
        int64_t id = id_at(ids, stride, i);
        if (id < smallest) smallest = id;
        if (id > largest) largest = id;
    }
    uint64_t gap = (uint64_t)largest - (uint64_t)smallest;
    map->first = smallest;
    if (gap / 4 <= (uint64_t)count) {
        map->span = gap + 1;
        return build_table(map, ids, stride, clash);
    }
    return build_pairs(map, ids, stride, clash);
}

void lar_id_map_clear(lar_id_map *map) {
    free(map->table);
    free(map->pair);
    *map = (lar_id_map){0};
}

int32_t lar_id_map_find(const lar_id_map *map, int64_t id) {
    if (map->table) {
        uint64_t offset = (uint64_t)id - (uint64_t)map->first;
        return offset < map->span ? map->table[offset] : -1;
    }
    int32_t low = 0, high = map->pair ? map->count : 0;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (map->pair[middle].id < id)
            low = middle + 1;
        else
            high = middle;
    }
    bool found = map->pair && low < map->count && map->pair[low].id == id;
    return found ? map->pair[low].index : -1;
}
