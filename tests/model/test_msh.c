#include "mesh_test.h"

#include <math.h>

/* Two cubes side by side along x in all the ways that Gmsh writes them. Nodes 1-8 are the first
 * cube, 9-12 the far end; node 13 belongs to no element. */
static const double points[13][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1},
                                     {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {2, 0, 0}, {2, 1, 0},
                                     {2, 0, 1}, {2, 1, 1}, {7, 7, 7}};
static const int hexes[2][8] = {{1, 2, 3, 4, 5, 6, 7, 8}, {2, 9, 10, 3, 6, 11, 12, 7}};

static const char *const version_1 =
    "$NOD\n13\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n"
    "9 2 0 0\n10 2 1 0\n11 2 0 1\n12 2 1 1\n13 7 7 7\n$ENDNOD\n"
    "$ELM\n3\n"
    "7 5 5 1 8 1 2 3 4 5 6 7 8\n"
    "8 5 6 1 8 2 9 10 3 6 11 12 7\n"
    "9 3 2 1 4 9 10 12 11\n$ENDELM\n";

static const char *const version_2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
    "$Comments\n$Nodes are below\n$EndComments\n"
    "$PhysicalNames\n5\n0 1 \"corner\"\n1 3 \"edge line\"\n2 2 \"end\"\n3 5 \"soft\"\n3 6 \"end\"\n"
    "$EndPhysicalNames\n"
    "$Nodes\n13\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n"
    "9 2 0 0\n10 2 1 0\n11 2 0 1\n12 2 1 1\n13 7 7 7\n$EndNodes\n"
    "$Elements\n7\n"
    "1 15 2 1 1 5\n"
    "2 1 2 3 1 4 8\n"
    "3 3 2 2 1 9 10 12 11\n"
    "4 3 0 1 2 3 4\n"
    "7 5 2 5 1 1 2 3 4 5 6 7 8\n"
    "8 5 2 6 1 2 9 10 3 6 11 12 7\n"
    "9 5 2 5 1 2 9 10 3 6 11 12 7\n"
    "$EndElements\n";

static const char *const version_4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    "$PhysicalNames\n4\n0 1 \"corner\"\n2 2 \"end\"\n3 5 \"soft\"\n3 6 \"end\"\n$EndPhysicalNames\n"
    "$Entities\n1 1 2 2\n"
    "1 0 0 1 1 1\n"
    "1 0 0 0 0 0 1 0 2 1 -1\n"
    "3 2 0 0 2 1 1 1 -2 0\n"
    "4 0 0 0 0 1 1 0 1 1\n"
    "1 0 0 0 1 1 1 1 5 0\n"
    "2 1 0 0 2 1 1 2 6 5 2 3 -4\n"
    "$EndEntities\n"
    "$Nodes\n3 13 1 13\n"
    "3 1 0 8\n1\n2\n3\n4\n5\n6\n7\n8\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
    "2 3 1 4\n9\n10\n11\n12\n"
    "2 0 0 0.5 0.5\n2 1 0 0.5 0.5\n2 0 1 0.5 0.5\n2 1 1 0.5 0.5\n"
    "3 2 0 1\n13\n7 7 7\n$EndNodes\n"
    "$Elements\n5 5 1 9\n"
    "0 1 15 1\n1 5\n"
    "2 3 3 1\n3 9 10 12 11\n"
    "2 4 3 1\n4 1 4 8 5\n"
    "3 1 5 1\n7 1 2 3 4 5 6 7 8\n"
    "3 2 5 1\n8 2 9 10 3 6 11 12 7\n"
    "$EndElements\n";

/* ---- binary files ------------------------------------------------------------------------- */

typedef struct writer {
    unsigned char data[8192];
    size_t size;
} writer;

static void put(writer *out, const void *data, size_t size) {
    assert_true(out->size + size <= sizeof out->data);
    memcpy(out->data + out->size, data, size);
    out->size += size;
}

static void put_text(writer *out, const char *text) {
    put(out, text, strlen(text));
}

static void put_int(writer *out, int value) {
    int32_t number = value;
    put(out, &number, sizeof number);
}

static void put_size(writer *out, uint64_t value) {
    put(out, &value, sizeof value);
}

static void put_point(writer *out, int n) {
    put(out, points[n], sizeof points[n]);
}

static void put_header(writer *out, const char *version, int one) {
    put_text(out, "$MeshFormat\n");
    put_text(out, version);
    put_text(out, " 1 8\n");
    put_int(out, one);
    put_text(out, "\n$EndMeshFormat\n$PhysicalNames\n3\n2 2 \"end\"\n3 5 \"soft\"\n3 6 \"end\"\n"
                  "$EndPhysicalNames\n");
}

static void put_binary_2(writer *out) {
    put_header(out, "2.2", 1);
    put_text(out, "$Nodes\n13\n");
    for (int n = 0; n < 13; n++) {
        put_int(out, n + 1);
        put_point(out, n);
    }
    put_text(out, "\n$EndNodes\n$Elements\n3\n");
    static const int quad[] = {3, 1, 2, 3, 2, 1, 9, 10, 12, 11}, block[] = {5, 2, 2};
    for (int i = 0; i < 10; i++) put_int(out, quad[i]);
    for (int i = 0; i < 3; i++) put_int(out, block[i]);
    for (int e = 0; e < 2; e++) {
        put_int(out, 7 + e);
        put_int(out, 5 + e);
        put_int(out, 1);
        for (int a = 0; a < 8; a++) put_int(out, hexes[e][a]);
    }
    put_text(out, "\n$EndElements\n");
}

static void put_entity(writer *out, int number, int physical) {
    put_int(out, number);
    for (int i = 0; i < 2; i++) put_point(out, i);
    put_size(out, 1);
    put_int(out, physical);
    put_size(out, 1);
    put_int(out, -1);
}

static void put_block(writer *out, int dimension, int entity, int type, uint64_t count) {
    put_int(out, dimension);
    put_int(out, entity);
    put_int(out, type);
    put_size(out, count);
}

static void put_binary_4(writer *out) {
    put_header(out, "4.1", 1);
    put_text(out, "$Entities\n");
    static const uint64_t entities[] = {1, 0, 1, 2}, nodes[] = {2, 13, 1, 13},
                          elements[] = {3, 3, 3, 8};
    for (int i = 0; i < 4; i++) put_size(out, entities[i]);
    put_int(out, 1);
    put_point(out, 0);
    put_size(out, 0);
    put_entity(out, 3, 2);
    put_entity(out, 2, 6);
    put_entity(out, 1, 5);
    put_text(out, "\n$EndEntities\n$Nodes\n");
    for (int i = 0; i < 4; i++) put_size(out, nodes[i]);
    put_block(out, 1, 1, 1, 1);
    put_size(out, 13);
    put_point(out, 12);
    put(out, points[0], 8);
    put_block(out, 3, 1, 0, 12);
    for (int n = 0; n < 12; n++) put_size(out, (uint64_t)n + 1);
    for (int n = 0; n < 12; n++) put_point(out, n);
    put_text(out, "\n$EndNodes\n$Elements\n");
    for (int i = 0; i < 4; i++) put_size(out, elements[i]);
    static const int quad[] = {3, 9, 10, 12, 11};
    put_block(out, 2, 3, 3, 1);
    for (int i = 0; i < 5; i++) put_size(out, (uint64_t)quad[i]);
    for (int e = 0; e < 2; e++) {
        put_block(out, 3, e + 1, 5, 1);
        put_size(out, (uint64_t)e + 7);
        for (int a = 0; a < 8; a++) put_size(out, (uint64_t)hexes[e][a]);
    }
    put_text(out, "\n$EndElements\n");
}

/* ---- what is read ------------------------------------------------------------------------- */

static lar_mesh read_two_cubes(const void *data, size_t size) {
    lar_mesh mesh = parse_good(lar_msh_parse, "two.msh", data, size);
    assert_int_equal(mesh.node_count, 12);
    assert_int_equal(mesh.dropped_node_count, 1);
    assert_int_equal(mesh.element_count, 2);
    for (int n = 0; n < 12; n++) {
        assert_memory_equal(mesh.position[n], points[mesh.node_id[n] - 1], sizeof points[0]);
        assert_int_equal(mesh.node_id[n], n + 1);
    }
    for (int e = 0; e < 2; e++) {
        assert_int_equal(mesh.element_id[e], 7 + e);
        for (int a = 0; a < 8; a++) assert_int_equal(mesh.element[e][a] + 1, hexes[e][a]);
    }
    assert_int_equal(mesh.element_tag[0], 5);
    assert_int_equal(mesh.element_tag[1], 6);
    assert_true(mesh_volume(&mesh) == 2);
    assert_string_equal(mesh.source, "two.msh");
    return mesh;
}

static void reads_version_1(void **state) {
    (void)state;
    lar_mesh mesh = read_two_cubes(version_1, strlen(version_1));
    assert_int_equal(mesh.set_count, 0);
    lar_mesh_clear(&mesh);
}

static void reads_version_2(void **state) {
    (void)state;
    lar_mesh mesh = read_two_cubes(version_2, strlen(version_2));
    assert_int_equal(mesh.set_count, 6);
    ASSERT_SET(&mesh, "corner", LAR_SET_NODES, 4);
    ASSERT_SET(&mesh, "edge line", LAR_SET_NODES, 3, 7);
    ASSERT_SET(&mesh, "end", LAR_SET_NODES, 8, 9, 10, 11);
    ASSERT_SET(&mesh, "end", LAR_SET_FACES, 6 + 1);
    ASSERT_SET(&mesh, "end", LAR_SET_ELEMENTS, 1);
    /* Gmsh writes element 8 once more, as 9, for its second group. */
    ASSERT_SET(&mesh, "soft", LAR_SET_ELEMENTS, 0, 1);
    lar_mesh_clear(&mesh);
}

/* Version 2.0 names groups without their dimension; lines may end as on Windows. */
static void reads_old_names(void **state) {
    (void)state;
    char *old = with(version_2, "2.2 0 8", "2 0 8");
    char *names = with(old, "5\n0 1 \"corner\"\n1 3 \"edge line\"\n2 2 \"end\"\n3 5 \"soft\"\n3 6",
                       "3\r\n2 \"face\"\r\n5 \"soft\"\n6");
    lar_mesh mesh = read_two_cubes(names, strlen(names));
    ASSERT_SET(&mesh, "face", LAR_SET_FACES, 6 + 1);
    ASSERT_SET(&mesh, "end", LAR_SET_ELEMENTS, 1);
    lar_mesh_clear(&mesh);
    free(old);
    free(names);
}

static void reads_version_4(void **state) {
    (void)state;
    lar_mesh mesh = read_two_cubes(version_4, strlen(version_4));
    assert_int_equal(mesh.set_count, 5);
    ASSERT_SET(&mesh, "corner", LAR_SET_NODES, 4);
    ASSERT_SET(&mesh, "end", LAR_SET_NODES, 8, 9, 10, 11);
    ASSERT_SET(&mesh, "end", LAR_SET_FACES, 6 + 1);
    ASSERT_SET(&mesh, "end", LAR_SET_ELEMENTS, 1);
    ASSERT_SET(&mesh, "soft", LAR_SET_ELEMENTS, 0, 1);
    lar_mesh_clear(&mesh);
}

/* Entities, but no physical group at all. */
static void reads_without_groups(void **state) {
    (void)state;
    char *text = with(version_4,
                      "1 1 2 2\n1 0 0 1 1 1\n1 0 0 0 0 0 1 0 2 1 -1\n"
                      "3 2 0 0 2 1 1 1 -2 0\n4 0 0 0 0 1 1 0 1 1\n"
                      "1 0 0 0 1 1 1 1 5 0\n2 1 0 0 2 1 1 2 6 5 2 3 -4\n",
                      "0 0 0 2\n1 0 0 0 1 1 1 0 0\n2 1 0 0 2 1 1 0 0\n");
    lar_mesh mesh = parse_good(lar_msh_parse, "two.msh", text, strlen(text));
    assert_int_equal(mesh.element_count, 2);
    assert_int_equal(mesh.element_tag[1], 0);
    assert_int_equal(mesh.set_count, 0);
    lar_mesh_clear(&mesh);
    free(text);
}

static void reads_binary(void **state) {
    (void)state;
    for (int version = 2; version <= 4; version += 2) {
        writer out = {.size = 0};
        version == 2 ? put_binary_2(&out) : put_binary_4(&out);
        lar_mesh mesh = read_two_cubes(out.data, out.size);
        assert_int_equal(mesh.set_count, 4);
        ASSERT_SET(&mesh, "end", LAR_SET_NODES, 8, 9, 10, 11);
        ASSERT_SET(&mesh, "end", LAR_SET_FACES, 6 + 1);
        ASSERT_SET(&mesh, "end", LAR_SET_ELEMENTS, 1);
        ASSERT_SET(&mesh, "soft", LAR_SET_ELEMENTS, 0);
        lar_mesh_clear(&mesh);
    }
}

/* ---- what is refused ---------------------------------------------------------------------- */

#define REFUSED(text, status, ...)                                                                 \
    ASSERT_TEXT_REFUSED(lar_msh_parse, "bad.msh", text, status, __VA_ARGS__)

/* A good file with one change must be refused. */
static void refused_with(const char *text, const char *old, const char *fresh, lar_status status,
                         const char *part) {
    char *changed = with(text, old, fresh);
    REFUSED(changed, status, part, "bad.msh");
    free(changed);
}

static void refuses_damage(void **state) {
    (void)state;
    const lar_status format = LAR_ERROR_FORMAT;
    REFUSED("", format, "bad.msh:1: the file ends without a section $Nodes");
    REFUSED("hello\n", format, "bad.msh:1: expected a section such as $MeshFormat");
    REFUSED("$Nodes\n0\n$EndNodes\n", format, "bad.msh:1: $Nodes stands before any $MeshFormat");
    REFUSED("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Data\n1\n", format,
            "bad.msh:4: the section has no $EndData");
    refused_with(version_2, "$Nodes\n13", "$Nodes\n10000000000", format,
                 "bad.msh:16: $Nodes announces 10000000000 nodes, but only");
    refused_with(version_2, "$Elements\n7", "$Elements\n10000000000", format,
                 "$Elements announces 10000000000 elements, but only");
    refused_with(version_2, "$Nodes\n13", "$Nodes\n-1", format, "$Nodes announces -1 nodes");
    refused_with(version_2, "$Nodes\n13", "$Nodes\n12", format, "bad.msh:28: expected $EndNodes");
    refused_with(version_2, "$Nodes\n13", "$Nodes\n14", format,
                 "bad.msh:30: expected a node id in $Nodes, found '$EndNodes'");
    refused_with(version_2, "12 2 1 1\n", "12 2 nan 1\n", format,
                 "bad.msh:28: node 12 has the y coordinate nan");
    refused_with(version_2, "12 2 1 1\n", "11 2 1 1\n", format,
                 "bad.msh:28: node 11 is given twice (first in line 27)");
    refused_with(version_2, "10 3 6 11 12 7\n9", "10 3 6 11 99 7\n9", format,
                 "bad.msh:38: element 8 names node 99");
    refused_with(version_2, "\n8 5 2 6 1 2 9", "\n7 5 2 6 1 2 9", format,
                 "bad.msh:38: element 7 is given twice (first in line 37)");
    refused_with(version_2, "9 10 12 11\n", "9 10 12 1\n", format,
                 "bad.msh:35: the quadrilateral 9 10 12 1 of set 'end' is not a face");
    refused_with(version_2, "7 5 2 5 1 1 2", "7 5 -2 5 1 1 2", format, "an element has -2 tags");
    refused_with(version_1, "9 3 2 1 4 9", "9 3 2 1 5 9", format,
                 "bad.msh:21: element 9 is a four-node quadrilateral with 5 nodes");
    refused_with(version_4, "2 2 \"end\"", "2 2 end", format,
                 "bad.msh:7: expected a physical name");
    refused_with(version_4, "3 13 1 13", "3 14 1 13", format,
                 "$Nodes announces 14 nodes, but its blocks hold 13");
    refused_with(version_4, "5 5 1 9", "5 6 1 9", format,
                 "$Elements announces 6 elements, but its blocks hold 5");
    refused_with(version_4, "3 1 0 8\n", "3 1 0 9999999999999\n", format, "$Nodes announces");
    refused_with(version_4, "3 1 5 1\n", "3 1 5 9223372036854775807\n", format,
                 "$Elements announces");
    refused_with(version_4, "3 1 0 8\n", "-3 1 0 8\n", format, "has the dimension -3");
    refused_with(version_4, "4 0 0 0 0 1 1 0", "4 0 0 0 0 1 1 99999999999", format,
                 "$Entities announces 99999999999 physical groups");
}

static void refuses_bad_elements(void **state) {
    (void)state;
    const lar_status model = LAR_ERROR_MODEL;
    refused_with(version_2, "7 5 2 5 1 1 2 3 4", "7 5 2 5 1 1 2 3 3", model,
                 "element 7 has node 3 twice");
    refused_with(version_1, "7 5 5 1 8 1 2 3 4 5 6 7 8", "7 5 5 1 8 5 6 7 8 1 2 3 4", model,
                 "element 7 is inside out");
    refused_with(version_1, "7 5 5 1 8 1 2 3 4", "7 5 5 1 8 2 1 3 4", model,
                 "element 7 is inverted or too distorted");
    refused_with(version_1, "3\n7 5 5 1 8 1 2 3 4 5 6 7 8\n8 5 6 1 8 2 9 10 3 6 11 12 7\n", "1\n",
                 model, "holds no eight-node hexahedra");
}

static void refuses_other_cells(void **state) {
    (void)state;
    const lar_status unsupported = LAR_ERROR_UNSUPPORTED;
    refused_with(version_2, "1 15 2 1 1 5", "1 4 2 1 1 5 6 7 8", unsupported,
                 "bad.msh:33: element 1 is a four-node tetrahedron, but Lariat computes with "
                 "eight-node hexahedra; make them of the mesh's boundary and regions: lariat mesh "
                 "bad.msh");
    refused_with(version_2, "1 15 2 1 1 5", "1 17 2 1 1 5", unsupported, "a 20-node hexahedron");
    refused_with(version_1, "9 3 2 1 4", "9 12 2 1 27", unsupported,
                 "bad.msh:21: element 9 is a 27-node hexahedron");
    refused_with(version_4, "0 1 15 1\n1 5", "3 1 92 1\n1 5", unsupported,
                 "element 1 is a 64-node hexahedron");
    refused_with(version_4, "0 1 15 1\n1 5", "3 1 77 1\n1 5", unsupported,
                 "element 1 has the type 77, which is not known");
    refused_with(version_2, "3 3 2 2 1 9 10 12 11", "3 2 2 2 1 9 10 12", unsupported,
                 "bad.msh:35: element 3 of the physical group 'end' is a three-node triangle");
}

static void refuses_other_formats(void **state) {
    (void)state;
    const lar_status unsupported = LAR_ERROR_UNSUPPORTED;
    refused_with(version_2, "2.2 0 8", "4 0 8", unsupported,
                 "Gmsh format 4 is not read; save the mesh as version 4.1 or 2.2");
    refused_with(version_2, "2.2 0 8", "nan 0 8", unsupported, "Gmsh format nan is not read");
    refused_with(version_2, "2.2 0 8", "2.2 0 4", unsupported, "data size 4 is not read");
    refused_with(version_4, "$Entities", "$PartitionedEntities", unsupported,
                 "the section $PartitionedEntities is not read");
    writer out = {.size = 0};
    put_header(&out, "4.1", 0x01000000);
    assert_refused(lar_msh_parse, "bad.msh", out.data, out.size, unsupported,
                   (const char *const[]){"bad.msh: byte 24", "other byte order", NULL});
    out.size = 0;
    put_header(&out, "4.1", 77);
    assert_refused(lar_msh_parse, "bad.msh", out.data, out.size, LAR_ERROR_FORMAT,
                   (const char *const[]){"integer one that begins binary data reads 77", NULL});
}

static void refuses_binary_claims(void **state) {
    (void)state;
    writer out = {.size = 0};
    put_header(&out, "4.1", 1);
    put_text(&out, "$Nodes\n");
    put_size(&out, 1);
    put_size(&out, 1ull << 40);
    put_size(&out, 1);
    put_size(&out, 1);
    put_text(&out, "and so on, but not for long");
    assert_refused(lar_msh_parse, "bad.msh", out.data, out.size, LAR_ERROR_FORMAT,
                   (const char *const[]){"bad.msh: byte ", "1099511627776 nodes", NULL});
    out.size = 0;
    put_header(&out, "2.2", 1);
    put_text(&out, "$Nodes\n0\n$EndNodes\n$Elements\n1\n");
    static const int block[] = {5, 1, INT32_MAX, 1, 2, 3};
    for (int i = 0; i < 6; i++) put_int(&out, block[i]);
    assert_refused(lar_msh_parse, "bad.msh", out.data, out.size, LAR_ERROR_FORMAT,
                   (const char *const[]){"bad.msh: byte ", "1 elements", NULL});
}

/* Few bytes that ask for very many set entries: every group names the element again. */
static void refuses_repeats(void **state) {
    (void)state;
    enum { GROUPS = 2000, CELLS = 2000 };
    char *text = malloc(GROUPS * 40 + CELLS * 40 + 1000), *at = text;
    assert_non_null(text);
    at += sprintf(at, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n%d\n", GROUPS);
    for (int g = 1; g <= GROUPS; g++) at += sprintf(at, "3 %d \"g%d\"\n", g, g);
    at += sprintf(at, "$EndPhysicalNames\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 %d", GROUPS);
    for (int g = 1; g <= GROUPS; g++) at += sprintf(at, " %d", g);
    at += sprintf(at, " 0\n$EndEntities\n$Elements\n1 %d 1 9\n3 1 5 %d\n", CELLS, CELLS);
    for (int e = 1; e <= CELLS; e++) at += sprintf(at, "%d 1 2 3 4 5 6 7 8\n", e);
    strcpy(at, "$EndElements\n");
    REFUSED(text, LAR_ERROR_UNSUPPORTED, "repeat the same elements more often");
    free(text);
}

static void every_prefix(void **state) {
    (void)state;
    sweep_prefixes(lar_msh_parse, "cut.msh", version_1, strlen(version_1));
    sweep_prefixes(lar_msh_parse, "cut.msh", version_2, strlen(version_2));
    sweep_prefixes(lar_msh_parse, "cut.msh", version_4, strlen(version_4));
    writer out = {.size = 0};
    put_binary_2(&out);
    sweep_prefixes(lar_msh_parse, "cut.msh", out.data, out.size);
    out.size = 0;
    put_binary_4(&out);
    sweep_prefixes(lar_msh_parse, "cut.msh", out.data, out.size);
}

/* ---- files of others ---------------------------------------------------------------------- */

static lar_status read_shared(const char *name, lar_mesh *mesh, lar_error *error) {
    char path[1000];
    snprintf(path, sizeof path, "%s/data/%s", LAR_TEST_SHARED, name);
    need_shared(path);
    *mesh = (lar_mesh){0};
    return lar_mesh_read(path, 1, mesh, error);
}

static void shared_hexahedra(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int32_t nodes, elements, boundary;
        double volume, smallest, mean;
    } files[] = {
        {"volumes/nine_hexa.msh", 32, 9, 30, 9, 1, 1},
        {"volumes/nifty_box8.msh", 36, 12, 32, 0.333334, 1, 1},
        {"bench/silicone_cylinder/cylinder_Hexa.msh", 5740, 4920, 1526, 2.00581e-4, 0.766, 0.945},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        lar_mesh mesh;
        lar_error error;
        if (read_shared(files[i].name, &mesh, &error)) fail_msg("%s", error.message);
        assert_int_equal(mesh.node_count, files[i].nodes);
        assert_int_equal(mesh.element_count, files[i].elements);
        assert_true(fabs(mesh_volume(&mesh) / files[i].volume - 1) < 5e-6);
        double smallest = 1, sum = 0;
        for (int32_t e = 0; e < mesh.element_count; e++) {
            double corner[8][3];
            lar_mesh_corners(&mesh, e, corner);
            double quality = lar_scaled_jacobian((const double(*)[3])corner);
            smallest = fmin(smallest, quality);
            sum += quality;
        }
        assert_true(fabs(smallest - files[i].smallest) < 1e-3);
        assert_true(fabs(sum / mesh.element_count - files[i].mean) < 1e-3);
        int32_t *faces, count;
        assert_int_equal(lar_mesh_boundary(&mesh, &faces, &count, &error), LAR_OK);
        assert_int_equal(count, files[i].boundary);
        free(faces);
        lar_mesh_clear(&mesh);
    }
}

static void shared_tetrahedra(void **state) {
    (void)state;
    static const char *const names[] = {"volumes/liver_tet.msh", "volumes/msh4_cube.msh"};
    static const char *const parts[] = {"liver_tet.msh:187: element 1 is a four-node tetrahedron",
                                        "msh4_cube.msh:165: element 45 is a four-node tetra"};
    for (int i = 0; i < 2; i++) {
        lar_mesh mesh;
        lar_error error = {0};
        assert_int_equal(read_shared(names[i], &mesh, &error), LAR_ERROR_UNSUPPORTED);
        assert_says(&error, parts[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_version_1),       cmocka_unit_test(reads_version_2),
        cmocka_unit_test(reads_old_names),       cmocka_unit_test(reads_version_4),
        cmocka_unit_test(reads_without_groups),  cmocka_unit_test(reads_binary),
        cmocka_unit_test(refuses_damage),        cmocka_unit_test(refuses_bad_elements),
        cmocka_unit_test(refuses_other_cells),   cmocka_unit_test(refuses_other_formats),
        cmocka_unit_test(refuses_binary_claims), cmocka_unit_test(refuses_repeats),
        cmocka_unit_test(every_prefix),          cmocka_unit_test(shared_hexahedra),
        cmocka_unit_test(shared_tetrahedra),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
