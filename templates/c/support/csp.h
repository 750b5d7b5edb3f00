/* SPDX-License-Identifier: 0BSD */
/* What generated code includes: the whole kernel. */
#ifndef CSP_H
#define CSP_H

#include "csp_alternative.h"
#include "csp_channels.h"
#include "csp_core.h"
#include "csp_external.h"
#include "csp_offers.h"
#include "csp_process.h"
#include "csp_program.h"

#endif
