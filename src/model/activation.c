#include "model/activation.h"

#include <math.h>

/* cos^2(pi x) for |x| <= 1/2, to 1e-14. */
static double pulse(double x) {
    double y = 3.14159265358979323846 * x, z = y * y, sum = 1;
    for (int k = 20; k > 0; k -= 2) sum = 1 - z * sum / (k * (k - 1));
    return sum * sum;
}

double lar_wave_place(const lar_wave *wave, const double corner[8][3]) {
    double place = 0;
    for (int i = 0; i < 3; i++) {
        double sum = 0;
        for (int a = 0; a < 8; a++) sum += corner[a][i];
        place += wave->direction[i] * sum;
    }
    return place / 8;
}

double lar_wave_value(const lar_wave *wave, double place, double time) {
    double behind = wave->speed * time - (place - wave->start); /* the front is so far ahead */
    double apart = wave->speed * wave->every;
    if (apart > 0 && behind > 0) behind -= apart * floor(behind / apart);
    if (!(behind > 0 && behind < wave->length)) return wave->rest;
    return wave->rest + (1 - wave->rest) * pulse(behind / wave->length - 0.5);
}
