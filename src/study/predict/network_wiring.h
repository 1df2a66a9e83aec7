/* Inside the prediction: which processor has which schedule, and where packets go.
 *
 *     sender's transfer  <-- partner -->  receiver's transfer     sender, receiver, stage name both
 *
 * Transfers and batches of all processors are numbered through.
 */
#ifndef LAR_STUDY_PREDICT_NETWORK_WIRING_H
#define LAR_STUDY_PREDICT_NETWORK_WIRING_H

#include "study/predict/network.h"

typedef struct lar_network_wiring {
    int32_t grid[3], processors;
    const lar_schedule **schedule; /* [processors] */
    int64_t *transfer_first;       /* [processors + 1] */
    int64_t *batch_first;          /* [processors + 1] */
    int64_t *partner;              /* [transfers] */
    int32_t *owner;                /* [transfers] processor */
} lar_network_wiring;

/* Clear it also after a failure. */
lar_status lar_wiring_make(const lar_network_options *options, lar_network_wiring *wiring,
                           lar_error *error);
void lar_wiring_clear(lar_network_wiring *wiring);

static inline int32_t lar_wiring_processor(const lar_network_wiring *w, int64_t transfer) {
    return w->owner[transfer];
}

static inline const lar_transfer *lar_wiring_transfer(const lar_network_wiring *w,
                                                      int32_t processor, int64_t transfer) {
    return &w->schedule[processor]->transfer[transfer - w->transfer_first[processor]];
}

#endif
