/// What ChibiOS must know of a board: its crystals. Pins are set by the boards' own code.
#ifndef BOARD_H
#define BOARD_H

#define STM32_LSECLK                        0U
#define STM32_HSECLK                        8000000U  /* [AMiRo-OS, board.h of this board] */

#endif
