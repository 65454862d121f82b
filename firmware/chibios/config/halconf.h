/// What the real boards use of ChibiOS's HAL 5: pins, I2C, SPI, and the clock tree and system timer that
/// are always there. CAN and the timers of the motors are ours (firmware/drivers): the HAL's CAN driver
/// knows neither transmit order by identifier nor abort.
#ifndef HALCONF_H
#define HALCONF_H

#include <mcuconf.h>

#define HAL_USE_PAL                         TRUE
#define HAL_USE_I2C                         TRUE
#define HAL_USE_SPI                         TRUE
#define HAL_USE_ADC                         FALSE
#define HAL_USE_CAN                         FALSE
#define HAL_USE_DAC                         FALSE
#define HAL_USE_EXT                         FALSE
#define HAL_USE_GPT                         FALSE
#define HAL_USE_I2S                         FALSE
#define HAL_USE_ICU                         FALSE
#define HAL_USE_MAC                         FALSE
#define HAL_USE_MMC_SPI                     FALSE
#define HAL_USE_PWM                         FALSE
#define HAL_USE_RTC                         FALSE
#define HAL_USE_SDC                         FALSE
#define HAL_USE_SERIAL                      FALSE
#define HAL_USE_SERIAL_USB                  FALSE
#define HAL_USE_UART                        FALSE
#define HAL_USE_USB                         FALSE
#define HAL_USE_WDG                         FALSE

/* The bus adapters lock for themselves, with the mutex of firmware/chibios/port.hpp. */
#define I2C_USE_MUTUAL_EXCLUSION            FALSE
#define SPI_USE_MUTUAL_EXCLUSION            FALSE
#define SPI_USE_WAIT                        TRUE

#endif
