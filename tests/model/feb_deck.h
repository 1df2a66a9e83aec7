/* FEBio decks made of pieces: two cubes side by side, and what may stand around them. */
#ifndef LAR_TESTS_FEB_DECK_H
#define LAR_TESTS_FEB_DECK_H

#include "model/format/mesh_io.h"
#include "model/model.h"
#include "testing.h"

#define HEAD4 "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n<Module type=\"solid\"/>\n"
#define CONTROL(analysis)                                                                          \
    "<Control><analysis>" analysis                                                                 \
    "</analysis><time_steps>10</time_steps><step_size>0.1</step_size></Control>\n"
#define MATERIAL                                                                                   \
    "<Material><material id=\"7\" name=\"soft\" type=\"neo-Hookean\"><density>1000</density>"      \
    "<E>3000</E><v>0.25</v></material></Material>\n"
/* Two cubes side by side in x, and a node that nothing uses. */
#define NODES                                                                                      \
    "<Nodes name=\"all\">\n<node id=\"1\">0,0,0</node><node id=\"2\">1,0,0</node>"                 \
    "<node id=\"3\">1,1,0</node><node id=\"4\">0,1,0</node><node id=\"5\">0,0,1</node>"            \
    "<node id=\"6\">1,0,1</node><node id=\"7\">1,1,1</node><node id=\"8\">0,1,1</node>"            \
    "<node id=\"9\">2,0,0</node><node id=\"10\">2,1,0</node><node id=\"11\">2,0,1</node>"          \
    "<node id=\"12\">2,1,1</node><node id=\"99\">5,5,5</node>\n</Nodes>\n"
#define PARTS                                                                                      \
    "<Elements type=\"hex8\" name=\"left\"><elem id=\"1\">1,2,3,4,5,6,7,8</elem></Elements>\n"     \
    "<Elements type=\"hex8\" name=\"right\"><elem id=\"2\">2,9,10,3,6,11,12,7</elem></Elements>\n"
#define SETS4                                                                                      \
    "<NodeSet name=\"wall\">1,4,\n5,8</NodeSet>\n<NodeSet name=\"tip\">9, 10 11,12</NodeSet>\n"    \
    "<ElementSet name=\"one\">2</ElementSet>\n"                                                    \
    "<Surface name=\"end\"><quad4 id=\"1\">9,10,12,11</quad4></Surface>\n"                         \
    "<Surface name=\"inward\"><quad4 id=\"1\">9,11,12,10</quad4></Surface>\n"                      \
    "<PartList name=\"both\">left, right</PartList>\n"
#define MESH4 "<Mesh>\n" NODES PARTS SETS4 "</Mesh>\n"
#define DOMAINS                                                                                    \
    "<MeshDomains><SolidDomain name=\"left\" mat=\"soft\"/><SolidDomain name=\"right\" "           \
    "mat=\"soft\"/></MeshDomains>\n"
/* The second line behind BASE4: of the first condition in a section of its own. */
enum { BC_LINE = 22 };
#define BASE4 HEAD4 CONTROL("DYNAMIC") MATERIAL MESH4 DOMAINS
#define CURVE(id, interpolate, extend, points)                                                     \
    "<load_controller id=\"" id "\" type=\"loadcurve\"><interpolate>" interpolate                  \
    "</interpolate><extend>" extend "</extend><points>" points "</points></load_controller>"
#define LINEAR1                                                                                    \
    "<LoadData>" CURVE("1", "LINEAR", "CONSTANT", "<pt>0,0</pt><pt>1,2</pt>") "</LoadData>\n"
#define TAIL "</febio_spec>\n"

TEST_UNUSED static lar_status parse_bytes(const char *text, size_t size, lar_model **model,
                                          lar_error *error) {
    /* A copy of the exact size, so that the address sanitizer sees reads beyond it. */
    lar_bytes bytes = {malloc(size + 1), size};
    assert_non_null(bytes.data);
    memcpy(bytes.data, text, size);
    bytes.data[size] = 0;
    lar_status status = lar_feb_parse("deck.feb", &bytes, model, error);
    free(bytes.data);
    return status;
}

TEST_UNUSED static lar_model *read_deck(const char *text) {
    lar_error error = {0};
    lar_model *model = NULL;
    if (parse_bytes(text, strlen(text), &model, &error)) fail_msg("%s", error.message);
    return model;
}

/* The deck must fail with this status and a message that begins with deck.feb:LINE: (line 0: any)
 * and holds the words. */
TEST_UNUSED static void expect_failure(const char *text, lar_status status, int line,
                                       const char *words) {
    lar_error error = {0};
    lar_model *model = NULL;
    lar_status got = parse_bytes(text, strlen(text), &model, &error);
    char start[40];
    snprintf(start, sizeof start, "deck.feb:%d: ", line);
    if (got != status || !strstr(error.message, words) ||
        (line && strncmp(error.message, start, strlen(start)) != 0))
        fail_msg("status %d (wanted %d), message '%s', wanted '%s...%s'", got, status,
                 error.message, start, words);
    assert_null(model);
}

TEST_UNUSED static int notices_with(const lar_model *model, const char *words) {
    int count = 0;
    for (int i = 0; i < model->notice_count; i++) count += strstr(model->notice[i], words) != NULL;
    return count;
}

#endif
