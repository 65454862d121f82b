"""examples/amiro-os/messages.json: a robot with AMiRo-OS is heard and driven; frames by hand, from its sources."""

import json
import os
import struct

from harness import SOURCE, Case, main

SPEC = os.path.join(SOURCE, "examples", "amiro-os", "messages.json")
BOARDS = {"di_wheel_drive": 1, "power_management": 2, "light_ring": 3, "cognition": 4}
DEVICES = {"actual_speed": 0x20, "position": 0x50, "floor": 0x51, "robot_id": 0x48, "power_status": 0x60, "target_speed": 0x10,
           "brightness": 0x40} | {f"ring_{i + 1}": 0x30 + i for i in range(8)}


class OfAmiroOs(Case):
    def test_each_identifier_is_a_device_and_its_board(self):
        with open(SPEC, encoding="utf-8") as file:
            messages = json.load(file)["messages"]
        self.assertEqual({message["name"]: int(message["id"], 16) for message in messages},
                         {message["name"]: DEVICES[message["name"]] << 3 | BOARDS[message["sender"]] for message in messages})

    def test_its_frames_are_decoded(self):
        # 0.05 m/s, -0.1 rad/s; a pose of 1.5 m, -0.25 m, 3.1 rad; the 4th sensor of the ring; 87 %, 93 min, 1200 mW.
        frames = [(0x101, struct.pack("<ii", 50_000, -100_000)),
                  (0x281, struct.pack("<i", 1_500_000 >> 8)[:3] + struct.pack("<i", -250_000 >> 8)[:3] + struct.pack("<h", 3_100_000 >> 8)),
                  (0x19A, struct.pack("<H", 2345)), (0x302, struct.pack("<BBHH", 3, 87, 93, 1200))]
        log = os.path.join(self.folder, "amiro.log")
        with open(log, "w", encoding="utf-8") as file:
            for number, (identifier, data) in enumerate(frames):
                file.write(f"({number + 1}.000000) can0 {identifier:03X}#{data.hex().upper()}\n")
        out, _ = self.run_tool("--spec", SPEC, "decode", log, "--json")
        speed, position, ring, power = [(each["topic"], each["fields"]) for each in self.objects(out)]
        self.assertEqual(speed, ("actual_speed", {"x": 0.05, "z": -0.1}))
        self.assertEqual(position[0], "position")
        for name, value in (("x", 1.5), ("y", -0.25), ("orientation", 3.1)):
            self.assertLess(abs(position[1][name] - value), 0.000256 + 1e-9)
        self.assertEqual(ring, ("ring_4", {"proximity": 2345}))
        self.assertEqual(power, ("power_status", {"flags": 3, "state_of_charge": 87, "minutes_remaining": 93, "power_consumption": 1200}))

    def test_it_is_driven(self):
        self.start_sim()
        listener = self.start("listen", "--raw")
        self.assertIn("bus: sim", listener.stderr.readline())
        self.settle()
        self.run_tool("--spec", SPEC, "set", "target_speed", "x=0.05m/s", "z=0rad/s")
        out, _ = self.interrupt(listener)
        self.assertIn("084#50C3000000000000", out)

    def test_all_of_it_fits_on_its_bus(self):
        out, _ = self.run_tool("analyse", "bus", SPEC)
        self.assertRegex(out, r"All meet their deadlines: 0\.[0-9]+ % of the bus \(1 Mbit/s")


if __name__ == "__main__":
    main()
