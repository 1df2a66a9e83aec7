/* Binding threads to cores, with hwloc where Lariat was built with it; otherwise nothing happens.
 *
 * Cores are numbered over those that this process may use, distinct cores first and the second
 * threads of cores behind them.
 */
#ifndef LAR_BASE_PIN_H
#define LAR_BASE_PIN_H

#include <stdbool.h>
#include <stdint.h>

/* Cores that threads can be bound to; 0 where none can. */
int32_t lar_pin_cores(void);

/* Binds the calling thread; false when it stays free. */
bool lar_pin_to(int32_t core);

/* Lets the calling thread run on all of them: a thread that was started by a bound one begins where
 * that is bound. Does nothing while no thread has been bound. */
void lar_pin_nowhere(void);

/* Where the calling thread may run now, for lar_pin_restore, which frees it. NULL is fine. */
typedef struct lar_pin lar_pin;
lar_pin *lar_pin_remember(void);
void lar_pin_restore(lar_pin *pin);

#endif
