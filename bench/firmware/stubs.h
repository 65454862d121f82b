/// What the stubs of work.h show, and how they are set.
#ifndef OCM_BENCH_FIRMWARE_STUBS_H
#define OCM_BENCH_FIRMWARE_STUBS_H

#include "work.h"

#ifdef __cplusplus
extern "C" {
#endif
extern volatile enum bus_answer bus_says;
extern volatile uint32_t sent_frames;
extern volatile uint32_t work_sum;  ///< of all frames sent and all set points applied, in their order
#ifdef __cplusplus
}
#endif
#endif
