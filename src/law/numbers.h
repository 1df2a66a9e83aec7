/* The least and the most that a parameter without a unit may be, but for powers (law/law.h). */
#ifndef LAR_LAW_NUMBERS_H
#define LAR_LAW_NUMBERS_H

#define LAR_LAW_NUMBER_MIN 1e-3
#define LAR_LAW_NUMBER_MAX 1e3

#endif
