/// Everything that a mapper refused, lost or could not do, a counter a cause; and what it did, to
/// compare. Plain numbers since the start, which wrap.
#pragma once

#include <cstdint>

#include "ocm/mapper/link/sentence_reader.hpp"
#include "ocm/motion/pose_estimator.hpp"
#include "ocm/scheduling/publisher.hpp"

namespace ocm::mapper::app {

struct Counters {
  // From the operator
  std::uint32_t heard = 0;           ///< whole sentences
  std::uint32_t refused = 0;         ///< sentences that the state does not allow
  link::ReaderFaults damaged{};      ///< what was no sentence
  std::uint32_t stray_bytes = 0;     ///< between sentences
  std::uint32_t input_full = 0;      ///< bytes that found the ring full
  std::uint32_t input_unlinked = 0;  ///< bytes that came without a link
  std::uint32_t input_dropped = 0;   ///< bytes of a link that died before they were looked at
  std::uint32_t orders_lost = 0;  ///< set points and stops that a newer one, or the end of the link, replaced

  // To the operator
  std::uint32_t handshakes = 0;  ///< sent; so the next three
  std::uint32_t updates = 0;
  std::uint32_t idles = 0;
  std::uint32_t pongs = 0;
  std::uint32_t unsent = 0;        ///< sentences for a link that was gone
  std::uint32_t out_of_range = 0;  ///< updates whose numbers no sentence holds
  std::uint32_t output_full = 0;   ///< bytes that found no room

  // Links
  std::uint32_t links = 0;
  std::uint32_t links_lost = 0;

  // Driving
  std::uint32_t set_points = 0;           ///< begun
  std::uint32_t arrived = 0;              ///< ended where they should
  std::uint32_t collisions = 0;           ///< stops in front of something
  std::uint32_t commands_lost = 0;        ///< to the motors, replaced by a newer one
  std::uint32_t commands_stale = 0;       ///< to the motors, given before they were switched off
  std::uint32_t motors_starved = 0;       ///< switched off since no command came
  std::uint32_t control_skipped = 0;      ///< estimates that no control step followed
  std::uint32_t control_rejected = 0;     ///< control steps without a finite pose or time
  std::uint32_t returns = 0;              ///< begun
  std::uint32_t returns_blocked = 0;      ///< ended in front of something
  std::uint32_t places_forgotten = 0;     ///< of the way home
  std::uint32_t calibrations = 0;         ///< turns for the compass that were begun
  std::uint32_t calibrations_failed = 0;  ///< those that ended without a calibration

  // Parts that did not answer
  std::uint32_t gyro = 0;
  std::uint32_t compass = 0;
  std::uint32_t infrared = 0;
  motion::EstimatorCounters estimator{};  ///< readings that were no numbers
  std::uint32_t ticks_rejected = 0;       ///< more than a wheel can make

  scheduling::Overload overload{};  ///< of all tasks
};

}  // namespace ocm::mapper::app
