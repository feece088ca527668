/* Evaluates an image at the states of the standard input and prints the answers, digits enough for every bit.

   agree IMAGE < STATES; a state of a module is a step and one pressure per FREE, of a single FREE a step, a pressure, a winding angle and a
   shear modulus. The pressures are those that sensors read; with the argument `commands` after IMAGE, those that are commanded.
   With SINGLE defined, in single precision. */

#include "../freeact.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef SINGLE
typedef float number;
#define OF(name) freeact_##name##_f32
#define READ "%f"
#else
typedef double number;
#define OF(name) freeact_##name##_f64
#define READ "%lf"
#endif

typedef OF(model) model_type;

#ifdef BARE
/* What a panic does, where the library was built without std. */
void freeact_panicked(void) { abort(); }
#endif

static void fail(const char *what, int32_t code) {
    fprintf(stderr, "%s: %d, %s\n", what, (int)code, freeact_error_text(code));
    exit(1);
}

static void print(const number *numbers, size_t count) {
    for (size_t index = 0; index < count; index++) printf(" %.17g", (double)numbers[index]);
}

/* Reads one state; zero at the end. */
static int state(number *numbers, size_t count) {
    for (size_t index = 0; index < count; index++) {
        if (scanf(READ, &numbers[index]) != 1) return 0;
    }
    return 1;
}

int main(int count, char **arguments) {
    if (count < 2 || freeact_abi() != FREEACT_ABI) return 2;
    FILE *file = fopen(arguments[1], "rb");
    if (!file) return 2;
    fseek(file, 0, SEEK_END);
    size_t bytes = (size_t)ftell(file);
    rewind(file);
    void *image = malloc(bytes);
    if (!image || fread(image, 1, bytes, file) != bytes) return 2;
    fclose(file);

    static model_type model;
    static OF(facts) facts;
    int32_t code = OF(open)(&model, image, bytes);
    if (code) fail(arguments[1], code);
    if ((code = OF(describe)(&model, &facts))) fail("facts", code);
    /* No more than is asked for, so that a tool that watches memory sees every step beyond. */
    number *memory = facts.memory ? malloc(facts.memory * sizeof *memory) : NULL;
    if ((code = OF(reset)(&model, memory, facts.memory))) fail("reset", code);
    printf("%s %u %u %u", facts.kind == FREEACT_MODULE ? "module" : "free", (unsigned)facts.frees, (unsigned)facts.memory,
           (unsigned)facts.has_error_bars);
    print(facts.least_pressure_pa, facts.frees);
    print(facts.greatest_pressure_pa, facts.frees);
    print(facts.winding_angle_rad, 3);
    print(facts.shear_modulus_pa, 3);
    printf("\n");

    int commands = count > 2 && !strcmp(arguments[2], "commands");
    number numbers[1 + FREEACT_MAX_FREES], *pressures = numbers + 1;
    size_t given = facts.kind == FREEACT_MODULE ? 1 + facts.frees : 4;
    while (state(numbers, given)) {
        number step = numbers[0];
        code = commands ? OF(supply)(&model, memory, facts.memory, step, pressures, facts.frees)
                        : OF(unread)(&model, pressures, facts.frees);
        if (code) fail("pressures", code);
        if (facts.kind == FREEACT_MODULE) {
            OF(pose) pose;
            code = OF(tip)(&model, memory, facts.memory, step, pressures, facts.frees, &pose);
            printf("%d", (int)code);
            if (!code) {
                number clearance, bars[2];
                print(pose.position_m, 3);
                print(pose.rotation_wxyz, 4);
                for (size_t free = 0; free < facts.frees; free++) print(pose.jacobian[free], 6);
                print(pose.answered_pa, facts.frees);
                if ((code = OF(clearance)(&model, pose.answered_pa, facts.frees, &clearance))) fail("clearance", code);
                print(&clearance, 1);
                code = OF(error_bars)(&model, pose.answered_pa, facts.frees, bars);
                if (!code) print(bars, 2);
                else if (code != FREEACT_NO_ERROR_BARS || facts.has_error_bars) fail("error bars", code);
            }
        } else {
            OF(deformation) found;
            code = OF(free)(&model, memory, facts.memory, step, pressures[0], pressures[1], pressures[2], &found);
            printf("%d", (int)code);
            if (!code) {
                number greatest;
                print(&found.axial_stretch, 1);
                print(&found.expansion, 1);
                print(&found.twist_per_length_rad_m, 1);
                for (size_t input = 0; input < 3; input++) print(found.jacobian[input], 3);
                /* Without the effects' winding angle the domain may end here. */
                if (!OF(greatest_pressure)(&model, pressures[1], pressures[2], &greatest)) print(&greatest, 1);
            }
        }
        printf("\n");
    }
    free(memory);
    free(image);
    return 0;
}
