/* SPDX-License-Identifier: 0BSD */
/* The constants of the program. */
#ifndef CONSTANTS_H
#define CONSTANTS_H

#include "csp_arithmetic.h"

static const double rotorInertia = 1.03e-06; /* plant.csp:5 */
/* Gear between motor and joint (published). */
static const double ratio = 5.3; /* plant.csp:7 */
/* Counts of the encoder in a revolution of the joint: 1024 lines on the motor shaft, counted
 * fourfold.
 */
static const double counts = 21708.8; /* plant.csp:11 */
/* Stiffness of the end stops (assumed). */
static const double stiffness = 50.0; /* plant.csp:13 */
/* Torque at the joint for a volt at the motor that stands still. */
static const double drive = 0.04835642201834862; /* plant.csp:16 */
/* Voltage that the turning joint induces. */
static const double induction = 0.12402; /* plant.csp:18 */
/* Nominal supply of the amplifiers; a duty of 1 is this voltage. */
static const double supply = 12.0; /* laws.csp:2 */
/* Sample period of the horizontal joint. */
static const int64_t Tsh = 2 * CSP_MS; /* jiwy.csp:5 */
/* Sample period of the vertical joint. */
static const int64_t Tsv = CSP_MS; /* jiwy.csp:7 */
/* What the joystick reports when its stop button is pressed. */
static const int64_t stopButton = 2; /* jiwy.csp:9 */

#endif
