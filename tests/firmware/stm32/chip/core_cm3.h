/* The core's registers and instructions, for the vendor's header of a chip: the real ones are at addresses
 * that sanitizers use. */
#pragma once

#include <stdint.h>

#define __I volatile const
#define __O volatile
#define __IO volatile
#define __IM volatile const
#define __OM volatile
#define __IOM volatile

typedef struct {
  volatile uint32_t ISER[8], ICER[8];
} NVIC_Type;
typedef struct {
  volatile uint32_t ICSR;
} SCB_Type;
typedef struct {
  volatile uint32_t CTRL;
} SysTick_Type;

extern NVIC_Type played_nvic;
extern SCB_Type played_scb;
extern SysTick_Type played_systick;
#define NVIC (&played_nvic)
#define SCB (&played_scb)
#define SysTick (&played_systick)
#define SCB_ICSR_PENDSVCLR_Msk (1U << 27) /* [ARMv7-M B3.2.4] */

void __disable_irq(void);
void __enable_irq(void);
void NVIC_SystemReset(void);
