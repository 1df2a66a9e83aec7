/* A target with a planted fault, for the driver's own test: it must find the number, save the
 * input and say so. */
#include <stdint.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char fault[] = "2147483648";
    size_t length = sizeof fault - 1;
    for (size_t i = 0; i + length <= size; i++)
        if (!memcmp(data + i, fault, length)) return 1;
    return 0;
}
