/* Calls that are wrong: each must end with its code, none may crash. misuse MODULE_F64 FREE_F64 MODULE_F32 (images). */

#include "../freeact.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;

#define EXPECT(expected, call)                                                                        \
    do {                                                                                              \
        int32_t found = (call);                                                                       \
        if (found != (expected)) {                                                                    \
            failures++;                                                                               \
            printf("line %d: %s is %d, %s\n", __LINE__, #call, (int)found, freeact_error_text(found)); \
        }                                                                                             \
    } while (0)

static unsigned char *load(const char *path, size_t *bytes) {
    FILE *file = fopen(path, "rb");
    if (!file) exit(2);
    fseek(file, 0, SEEK_END);
    *bytes = (size_t)ftell(file);
    rewind(file);
    unsigned char *image = malloc(*bytes);
    if (!image || fread(image, 1, *bytes, file) != *bytes) exit(2);
    fclose(file);
    return image;
}

static freeact_model_f64 module, single, other;
static freeact_model_f32 shorter;
static freeact_facts_f64 facts;
static freeact_pose_f64 pose;
static freeact_deformation_f64 deformation;
static double memory[1 << 16];
static unsigned char bent[sizeof(freeact_model_f64) + 8];

int main(int count, char **arguments) {
    if (count < 4) return 2;
    size_t bytes, of_single, of_short;
    unsigned char *image = load(arguments[1], &bytes);
    unsigned char *free_image = load(arguments[2], &of_single);
    unsigned char *short_image = load(arguments[3], &of_short);
    double pressures[FREEACT_MAX_FREES] = {10e3, 20e3, 5e3, 2e3}, number, bars[2];
    const size_t many = sizeof memory / sizeof *memory;

    /* Before anything is open. */
    EXPECT(FREEACT_NOT_OPEN, freeact_describe_f64(&module, &facts));
    EXPECT(FREEACT_NOT_OPEN, freeact_tip_f64(&module, memory, many, 0.0, pressures, 4, &pose));

    /* Images that are none. */
    EXPECT(FREEACT_NULL_POINTER, freeact_open_f64(NULL, image, bytes));
    EXPECT(FREEACT_NULL_POINTER, freeact_open_f64(&module, NULL, bytes));
    EXPECT(FREEACT_MISALIGNED, freeact_open_f64((freeact_model_f64 *)(void *)(bent + 1), image, bytes));
    EXPECT(FREEACT_NO_IMAGE, freeact_open_f64(&module, image, 0));
    EXPECT(FREEACT_IMAGE_LENGTH, freeact_open_f64(&module, image, bytes - 8));
    EXPECT(FREEACT_IMAGE_LENGTH, freeact_open_f64(&module, image, SIZE_MAX));
    EXPECT(FREEACT_IMAGE_PRECISION, freeact_open_f64(&module, short_image, of_short));
    EXPECT(FREEACT_IMAGE_PRECISION, freeact_open_f32(&shorter, image, bytes));
    unsigned char *shifted = malloc(bytes + 4);
    if (!shifted) return 2;
    memcpy(shifted + 4, image, bytes);
    EXPECT(FREEACT_IMAGE_ADDRESS, freeact_open_f64(&module, shifted + 4, bytes));
    memcpy(shifted, image, bytes);
    shifted[bytes - 3] ^= 0x40;
    EXPECT(FREEACT_IMAGE_CHECKSUM, freeact_open_f64(&module, shifted, bytes));
    shifted[8] = 9;
    EXPECT(FREEACT_IMAGE_VERSION, freeact_open_f64(&module, shifted, bytes));
    EXPECT(FREEACT_NOT_OPEN, freeact_describe_f64(&module, &facts));
    free(shifted);

    EXPECT(FREEACT_OK, freeact_open_f64(&module, image, bytes));
    EXPECT(FREEACT_OK, freeact_open_f64(&single, free_image, of_single));
    EXPECT(FREEACT_OK, freeact_open_f32(&shorter, short_image, of_short));

    /* The other precision. */
    EXPECT(FREEACT_NOT_OPEN, freeact_describe_f64((freeact_model_f64 *)(void *)&shorter, &facts));

    /* Pointers. */
    EXPECT(FREEACT_NULL_POINTER, freeact_describe_f64(NULL, &facts));
    EXPECT(FREEACT_NULL_POINTER, freeact_describe_f64(&module, NULL));
    EXPECT(FREEACT_OK, freeact_describe_f64(&module, &facts));
    EXPECT(FREEACT_NULL_POINTER, freeact_reset_f64(&module, NULL, many));
    EXPECT(FREEACT_SHORT_MEMORY, freeact_reset_f64(&module, memory, facts.memory - 1));
    EXPECT(FREEACT_OK, freeact_reset_f64(&module, memory, facts.memory));
    EXPECT(FREEACT_NULL_POINTER, freeact_supply_f64(&module, memory, many, 0.0, NULL, 4));
    EXPECT(FREEACT_NULL_POINTER, freeact_unread_f64(&module, NULL, 4));
    EXPECT(FREEACT_NULL_POINTER, freeact_tip_f64(&module, NULL, many, 0.0, pressures, 4, &pose));
    EXPECT(FREEACT_NULL_POINTER, freeact_tip_f64(&module, memory, many, 0.0, NULL, 4, &pose));
    EXPECT(FREEACT_NULL_POINTER, freeact_tip_f64(&module, memory, many, 0.0, pressures, 4, NULL));
    EXPECT(FREEACT_NULL_POINTER, freeact_clearance_f64(&module, pressures, 4, NULL));
    EXPECT(FREEACT_NULL_POINTER, freeact_free_f64(&single, memory, many, 0.0, 1e3, 0.5, 0.4e6, NULL));
    EXPECT(FREEACT_MISALIGNED,
           freeact_tip_f64(&module, (double *)(void *)((char *)memory + 1), many - 1, 0.0, pressures, 4, &pose));

    /* Numbers of numbers. */
    for (size_t frees = 0; frees < 9; frees++) {
        if (frees == 4) continue;
        EXPECT(FREEACT_WRONG_COUNT, freeact_tip_f64(&module, memory, many, 0.0, pressures, frees, &pose));
        EXPECT(FREEACT_WRONG_COUNT, freeact_clearance_f64(&module, pressures, frees, &number));
        EXPECT(FREEACT_WRONG_COUNT, freeact_supply_f64(&module, memory, many, 0.0, pressures, frees));
    }
    EXPECT(FREEACT_WRONG_COUNT, freeact_error_bars_f64(&module, pressures, SIZE_MAX, bars));
    EXPECT(FREEACT_SHORT_MEMORY, freeact_tip_f64(&module, memory, facts.memory - 1, 0.0, pressures, 4, &pose));

    /* Kinds. */
    EXPECT(FREEACT_WRONG_KIND, freeact_tip_f64(&single, memory, many, 0.0, pressures, 1, &pose));
    EXPECT(FREEACT_WRONG_KIND, freeact_clearance_f64(&single, pressures, 1, &number));
    EXPECT(FREEACT_WRONG_KIND, freeact_error_bars_f64(&single, pressures, 1, bars));
    EXPECT(FREEACT_WRONG_KIND, freeact_free_f64(&module, memory, many, 0.0, 1e3, 0.5, 0.4e6, &deformation));
    EXPECT(FREEACT_WRONG_KIND, freeact_greatest_pressure_f64(&module, 0.5, 0.4e6, &number));

    /* Values. What is no number is refused before the memory knows of it. */
    EXPECT(FREEACT_NEGATIVE_STEP, freeact_tip_f64(&module, memory, many, -0.1, pressures, 4, &pose));
    EXPECT(FREEACT_NOT_FINITE, freeact_tip_f64(&module, memory, many, NAN, pressures, 4, &pose));
    pressures[1] = NAN;
    EXPECT(FREEACT_NOT_FINITE, freeact_tip_f64(&module, memory, many, 0.0, pressures, 4, &pose));
    EXPECT(FREEACT_NOT_FINITE, freeact_supply_f64(&module, memory, many, 0.0, pressures, 4));
    EXPECT(FREEACT_NOT_FINITE, freeact_free_f64(&single, memory, many, 0.0, 1e3, INFINITY, 0.4e6, &deformation));
    pressures[1] = 20e3;
    for (size_t index = 0; index < facts.memory; index++) {
        if (memory[index] != 0.0) {
            failures++;
            printf("the memory has changed\n");
            break;
        }
    }
    EXPECT(FREEACT_OK, freeact_tip_f64(&module, memory, many, 0.0, pressures, 4, &pose));
    pressures[1] = 200e3;
    EXPECT(FREEACT_OUTSIDE_PRESSURE, freeact_tip_f64(&module, memory, many, 1.0, pressures, 4, &pose));
    EXPECT(FREEACT_OK, freeact_describe_f64(&single, &facts));
    EXPECT(FREEACT_OK, freeact_reset_f64(&single, memory, many));
    double angle = facts.winding_angle_rad[0], modulus = facts.shear_modulus_pa[0];
    EXPECT(FREEACT_OK, freeact_free_f64(&single, memory, many, 0.0, 1e3, angle, modulus, &deformation));
    EXPECT(FREEACT_OUTSIDE_PRESSURE, freeact_free_f64(&single, memory, many, 0.0, 1e6, angle, modulus, &deformation));
    EXPECT(FREEACT_OUTSIDE_ANGLE, freeact_free_f64(&single, memory, many, 0.0, 1e3, 1.5, modulus, &deformation));
    EXPECT(FREEACT_OUTSIDE_MODULUS, freeact_free_f64(&single, memory, many, 0.0, 1e3, angle, 9e6, &deformation));
    EXPECT(FREEACT_OUTSIDE_ANGLE, freeact_greatest_pressure_f64(&single, NAN, modulus, &number));

    /* A memory that was overwritten gives a wrong answer or none, but does not lead outside. */
    EXPECT(FREEACT_OK, freeact_describe_f64(&module, &facts));
    const double wrong[] = {1e300, -1e300, NAN, INFINITY};
    for (size_t which = 0; which < sizeof wrong / sizeof *wrong; which++) {
        for (size_t index = 0; index < many; index++) memory[index] = wrong[which];
        pressures[1] = 20e3;
        int32_t code = freeact_tip_f64(&module, memory, many, 0.01, pressures, 4, &pose);
        if (code != FREEACT_OK && code != FREEACT_OUTSIDE_PRESSURE) {
            failures++;
            printf("a memory of %g gives %d\n", wrong[which], (int)code);
        }
    }

    /* A model that is copied, and one that is opened again. */
    other = module;
    EXPECT(FREEACT_OK, freeact_describe_f64(&other, &facts));
    EXPECT(FREEACT_OK, freeact_open_f64(&other, free_image, of_single));
    EXPECT(FREEACT_OK, freeact_describe_f64(&other, &facts));
    if (facts.kind != FREEACT_FREE || facts.frees != 1) failures++;

    /* Every code has words. */
    for (int32_t code = -1; code < 40; code++) {
        if (strlen(freeact_error_text(code)) < 4) failures++;
    }
    if (strlen(freeact_version()) < 5 || freeact_image_version() != 2 || freeact_abi() != FREEACT_ABI) failures++;
    free(image);
    free(free_image);
    free(short_image);
    printf("%d failures\n", failures);
    return failures != 0;
}
