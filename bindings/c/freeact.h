/* freeact: models of FREE actuators (fibre-reinforced elastomeric enclosures), evaluated from an image.

   An image is a model as bytes: `freeact export X.model --out X.img`, with `--single` in single precision. It is evaluated where it
   lies, in flash memory say. No function allocates, locks, or keeps anything of its own.

   Units    SI: Pa (gauge), m, kg, s, rad.
   Frames   The base frame has +z from the base plate to the tip plate. At rest the plate's centre is at (0, 0, length), and the
            plate's frame has the directions of the base frame. Where the model has effects `base_frame` or `marker_frame`, poses are those that are read: of the marker, in
            the frame of the measurements.
   Signs    Turns and twist are positive about +z by the right hand. Winding angles are from the hoop: 90 degrees lie along the tube.
   Lifetime The image's bytes must stay as they are, where they are, as long as the model is used. A model holds no pointers to
            itself: it may be copied, and needs no closing.
   Address  An image lies at a multiple of 8 bytes (of 4 in single precision); models and structures as their types ask for.
   Threads  A model that is open is only read: any number of threads may evaluate it, each with a memory of its own.
   Time     Effects such as hysteresis, creep or lag remember the past in the caller's memory: `facts.memory` numbers, set to zero
            (`freeact_reset`) for an actuator that has rested. Each call goes one step in time further. Memory, structures and
            image may not overlap.
   Errors   Every function returns a code. But for FREEACT_OK nothing was written, with one exception: where there is no answer
            (codes from 20 on), the memory went on all the same. Numbers that are infinite or NaN are refused before that.

   Both precisions have the same functions: _f64 for images of 8-byte numbers, _f32 for those of 4. A model opened in one is not
   to be used in the other (FREEACT_NOT_OPEN). */

#ifndef FREEACT_H
#define FREEACT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of these calls; compare with freeact_abi() where the library is a shared one. */
#define FREEACT_ABI 1u
/* Greatest number of FREEs of a module. */
#define FREEACT_MAX_FREES 8
/* 64-bit words of a model. */
#define FREEACT_MODEL_WORDS 256

/* Kinds of models. */
#define FREEACT_FREE 1u
#define FREEACT_MODULE 2u

/* Codes. Their numbers never change. */
enum {
    FREEACT_OK = 0,
    /* The call is wrong. */
    FREEACT_NULL_POINTER = 1,
    FREEACT_MISALIGNED = 2,
    FREEACT_NOT_OPEN = 3,
    FREEACT_WRONG_KIND = 4,
    FREEACT_WRONG_COUNT = 5,
    FREEACT_SHORT_MEMORY = 6,
    FREEACT_NOT_FINITE = 7,
    FREEACT_NEGATIVE_STEP = 8,
    /* The image is none, or none for this library. */
    FREEACT_NO_IMAGE = 10,
    FREEACT_IMAGE_VERSION = 11,
    FREEACT_IMAGE_PRECISION = 12,
    FREEACT_IMAGE_ADDRESS = 13,
    FREEACT_IMAGE_ENDIAN = 14,
    FREEACT_IMAGE_LENGTH = 15,
    FREEACT_IMAGE_CHECKSUM = 16,
    FREEACT_IMAGE_UNKNOWN_EFFECT = 17,
    FREEACT_IMAGE_CONTENT = 18,
    /* The model has no answer there. */
    FREEACT_OUTSIDE_PRESSURE = 20,
    FREEACT_UNSTABLE = 21,
    FREEACT_OUTSIDE_ANGLE = 22,
    FREEACT_OUTSIDE_MODULUS = 23,
    FREEACT_NO_ERROR_BARS = 24,
    /* A defect of the library. */
    FREEACT_PANICKED = 30
};

/* What a code means and what helps; valid for ever. */
const char *freeact_error_text(int32_t code);
/* The version of freeact, as text; valid for ever. */
const char *freeact_version(void);
/* FREEACT_ABI of the library. */
uint32_t freeact_abi(void);
/* The newest version of images that the library reads; it reads those before too. */
uint32_t freeact_image_version(void);

/* Double precision. */

/* A model. Open it before anything else; what was set to zero instead is told to be not open. */
typedef struct {
    uint64_t words[FREEACT_MODEL_WORDS];
} freeact_model_f64;

/* What a model is of, and where it answers. */
typedef struct {
    /* FREEACT_FREE or FREEACT_MODULE. */
    uint32_t kind;
    /* Number of FREEs: every call takes as many pressures. */
    uint32_t frees;
    /* Numbers of memory that the effects need; 0 where none remembers anything. */
    uint32_t memory;
    /* Whether a module's model has error bars: 1 or 0. */
    uint32_t has_error_bars;
    /* The box of pressures that the splines answer, after the effects; zero beyond `frees`. A module's domain may end within the
       box, where states become unstable: see freeact_clearance_f64. Of a single FREE: from zero to the greatest at its own winding
       angle and shear modulus (zero where the model does not reach these). */
    double least_pressure_pa[FREEACT_MAX_FREES];
    double greatest_pressure_pa[FREEACT_MAX_FREES];
    /* A single FREE's own, the model's least, the model's greatest; zero of a module. */
    double winding_angle_rad[3];
    double shear_modulus_pa[3];
} freeact_facts_f64;

/* Pose of a module's tip. */
typedef struct {
    /* Centre of the tip plate, base frame. */
    double position_m[3];
    /* Unit quaternion (w, x, y, z) from the plate's frame to the base frame. It follows the twist through whole turns: after one the
       sign is the other. */
    double rotation_wxyz[4];
    /* jacobian[free]: per Pa of the pressure in that FREE, the rate of the position (m, base frame), then the angular rate (rad,
       plate's frame: R^T dR = [omega]x). What effects remember is held fixed. Zero beyond `frees`. */
    double jacobian[FREEACT_MAX_FREES][6];
    /* The pressures that the splines answered, after the effects: where clearance and error bars are to be looked up. */
    double answered_pa[FREEACT_MAX_FREES];
} freeact_pose_f64;

/* Deformation of a single FREE: far from its caps, or from cap to cap where its map was made with `--caps`. */
typedef struct {
    /* Length over that at rest. */
    double axial_stretch;
    /* Outer radius (of equal area) over that at rest. */
    double expansion;
    /* Twist over the length at rest, rad/m, with the sign of the FREE's hand. */
    double twist_per_length_rad_m;
    /* jacobian[input][output]: inputs pressure (Pa), winding angle (rad), shear modulus (Pa); outputs as above, in their order. Along
       an axis of which the map has a single value the model knows no derivative and gives zero. */
    double jacobian[3][3];
} freeact_deformation_f64;

/* Opens an image of `bytes` bytes. All of it is checked, its checksum too: that takes as long as reading it. */
int32_t freeact_open_f64(freeact_model_f64 *model, const void *image, size_t bytes);

/* Tells what a model is of, and where it answers. */
int32_t freeact_describe_f64(const freeact_model_f64 *model, freeact_facts_f64 *facts);

/* Sets the memory to that of an actuator that has rested. `length` is how many numbers there are in `memory`: `facts.memory` or more.
   Where `facts.memory` is zero, `memory` may be a null pointer, here and below. */
int32_t freeact_reset_f64(const freeact_model_f64 *model, double *memory, size_t length);

/* Commands to the supply (one per FREE) become the pressures in the FREEs `step_s` seconds after the last call, in place. The first
   call starts settled. To be left out where the pressures in the FREEs are measured. */
int32_t freeact_supply_f64(const freeact_model_f64 *model, double *memory, size_t length, double step_s,
                           double *pressures_pa, size_t frees);

/* Pressures as the sensors read them become the pressures in the FREEs, in place: a bias that the model knows is taken away. */
int32_t freeact_unread_f64(const freeact_model_f64 *model, double *pressures_pa, size_t frees);

/* Pose of a module's tip `step_s` seconds after the last call, at these pressures in the FREEs. */
int32_t freeact_tip_f64(const freeact_model_f64 *model, double *memory, size_t length, double step_s,
                        const double *pressures_pa, size_t frees, freeact_pose_f64 *pose);

/* Deformation of a single FREE `step_s` seconds after the last call, at a pressure in it, a winding angle from the hoop and a shear
   modulus (its own are in its facts; an effect `winding_angle` is added here). */
int32_t freeact_free_f64(const freeact_model_f64 *model, double *memory, size_t length, double step_s, double pressure_pa,
                         double winding_angle_rad, double shear_modulus_pa, freeact_deformation_f64 *deformation);

/* How much (Pa) every pressure of a module may change at once without leaving the domain, negative outside. The pressures are those
   that the splines answer (`pose.answered_pa`). */
int32_t freeact_clearance_f64(const freeact_model_f64 *model, const double *pressures_pa, size_t frees,
                              double *clearance_pa);

/* What 95 of 100 errors of a module's model against the finite elements stay below around pressures that the splines answer
   (`pose.answered_pa`): bars[0] of the position (m), bars[1] of the rotation (rad). */
int32_t freeact_error_bars_f64(const freeact_model_f64 *model, const double *pressures_pa, size_t frees, double bars[2]);

/* The greatest pressure of a single FREE's domain at a winding angle and a shear modulus, without effects. */
int32_t freeact_greatest_pressure_f64(const freeact_model_f64 *model, double winding_angle_rad, double shear_modulus_pa,
                                      double *pressure_pa);

/* Single precision: as above, in `float`. */

typedef struct {
    uint64_t words[FREEACT_MODEL_WORDS];
} freeact_model_f32;

typedef struct {
    uint32_t kind;
    uint32_t frees;
    uint32_t memory;
    uint32_t has_error_bars;
    float least_pressure_pa[FREEACT_MAX_FREES];
    float greatest_pressure_pa[FREEACT_MAX_FREES];
    float winding_angle_rad[3];
    float shear_modulus_pa[3];
} freeact_facts_f32;

typedef struct {
    float position_m[3];
    float rotation_wxyz[4];
    float jacobian[FREEACT_MAX_FREES][6];
    float answered_pa[FREEACT_MAX_FREES];
} freeact_pose_f32;

typedef struct {
    float axial_stretch;
    float expansion;
    float twist_per_length_rad_m;
    float jacobian[3][3];
} freeact_deformation_f32;

int32_t freeact_open_f32(freeact_model_f32 *model, const void *image, size_t bytes);
int32_t freeact_describe_f32(const freeact_model_f32 *model, freeact_facts_f32 *facts);
int32_t freeact_reset_f32(const freeact_model_f32 *model, float *memory, size_t length);
int32_t freeact_supply_f32(const freeact_model_f32 *model, float *memory, size_t length, float step_s,
                           float *pressures_pa, size_t frees);
int32_t freeact_unread_f32(const freeact_model_f32 *model, float *pressures_pa, size_t frees);
int32_t freeact_tip_f32(const freeact_model_f32 *model, float *memory, size_t length, float step_s,
                        const float *pressures_pa, size_t frees, freeact_pose_f32 *pose);
int32_t freeact_free_f32(const freeact_model_f32 *model, float *memory, size_t length, float step_s, float pressure_pa,
                         float winding_angle_rad, float shear_modulus_pa, freeact_deformation_f32 *deformation);
int32_t freeact_clearance_f32(const freeact_model_f32 *model, const float *pressures_pa, size_t frees,
                              float *clearance_pa);
int32_t freeact_error_bars_f32(const freeact_model_f32 *model, const float *pressures_pa, size_t frees, float bars[2]);
int32_t freeact_greatest_pressure_f32(const freeact_model_f32 *model, float winding_angle_rad, float shear_modulus_pa,
                                      float *pressure_pa);

/* Only where the library was built without std, for a controller: the program defines what a panic does. It may not return. No call is
   known to lead there. */
#if defined(__GNUC__)
__attribute__((noreturn))
#endif
void freeact_panicked(void);

#ifdef __cplusplus
}
#endif

#endif
