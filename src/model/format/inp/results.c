/* Abaqus and CalculiX decks: requests for results. See deck.h.
 *
 *     *NODE PRINT, NSET=Tip      two probes: "Tip", the mean displacement of the set, and
 *     U, RF                      "Tip reaction", the sum of what its supports bear
 *
 * What is asked of other cards Lariat writes in its own way: a notice, once, says how.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/format/inp/deck.h"

lar_status inp_notice_results(inp_deck *deck, const inp_card *card) {
    if (deck->results) return LAR_OK;
    deck->results = true;
    return inp_notice(deck, card->line,
                      "requests for results, *%.*s here, were left out but for U and RF of *NODE "
                      "PRINT, NSET=, which are probes; lariat run --out FOLDER writes these and "
                      "fields, a scene (output:) and Python have more",
                      inp_shown(card->keyword), card->keyword.at);
}

static lar_status add_probe(inp_deck *deck, const lar_set *set, bool reaction) {
    enum { MAX = 1000 }; /* as in scenes */
    char name[128];
    const lar_output *output = &deck->model->output;
    snprintf(name, sizeof name, "%.100s%s", set->name, reaction ? " reaction" : "");
    for (int i = 0; i < output->probe_count; i++)
        if (strcmp(output->probe[i].name, name) == 0) return LAR_OK;
    if (output->probe_count >= MAX)
        return inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                        "more than %d probes; remove some *NODE PRINT", MAX);
    lar_probe *probe = LAR_MODEL_APPEND(deck->model, output.probe);
    if (!probe) return inp_no_memory(deck, "the probes");
    probe->what = reaction ? LAR_PROBE_REACTION : LAR_PROBE_DISPLACEMENT;
    probe->name = lar_strdup(name);
    probe->nodes.node = lar_calloc((size_t)set->count, sizeof *probe->nodes.node);
    if (!probe->name || !probe->nodes.node) return inp_no_memory(deck, "the probes");
    memcpy(probe->nodes.node, set->index, (size_t)set->count * sizeof *set->index);
    probe->nodes.count = set->count;
    return LAR_OK;
}

lar_status inp_read_node_print(inp_deck *deck, const inp_card *card) {
    lar_span name, line, word;
    const lar_set *set = NULL;
    if (inp_parameter(card, "NSET", &name)) set = inp_mesh_set(deck, name, LAR_SET_NODES);
    lar_status status = LAR_OK;
    while (set && set->count > 0 && !status && inp_data_line(&deck->reader, &line))
        while (line.length > 0 && !status) {
            lar_span_split(line, ',', &word, &line);
            word = lar_span_trim(word);
            bool reaction = lar_span_equal_nocase(word, "RF");
            if (reaction || lar_span_equal_nocase(word, "U"))
                status = add_probe(deck, set, reaction);
        }
    return status;
}
