"""Foxglove's own client of its protocol on the port of amiroctl serve."""

import json
import os
import subprocess
import sys

sys.path.insert(0, os.path.join(os.environ["OCM_SOURCE_DIR"], "tests", "tool", "verbs"))
import browser
import harness
import jsonschema

CLIENT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "foxglove_client.mjs")


class Foxglove(harness.Case):
    def serve(self, *arguments):
        server = self.start("serve", "--port", "0", *arguments)
        address, _, token = server.stdout.readline().strip().partition("#")
        return address.replace("http:", "ws:") + (f"?token={token}" if token else "")

    def client(self, *arguments):
        process = harness.waiting.Program(["node", CLIENT, browser.node_modules(), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self._started.append(process)
        self.assertEqual(process.stderr.readline(), "ready\n")
        return process

    def test_it_understands_all(self):
        self.start_sim("--frozen")
        client = self.client(self.serve(), "/gyroscope", "3")
        self.settle()
        for low in (1, 2, 3):
            self.run_tool("send", f"608#{low:02X}0000000000")
        seen = json.loads(client.communicate(timeout=90)[0])
        self.assertEqual([message["fields"] for message in seen["messages"]], [{"x": x, "y": 0, "z": 0} for x in (0.0175, 0.035, 0.0525)])
        self.assertEqual(seen["info"]["capabilities"], [])
        self.assertEqual(seen["statuses"], [])
        channels = {channel["topic"]: channel for channel in seen["channels"]}
        self.assertEqual({(channel["encoding"], channel["schemaEncoding"]) for channel in channels.values()}, {("json", "jsonschema")})
        self.assertEqual(set(channels["/gyroscope"]["schema"]["properties"]), {"x", "y", "z"})

    @staticmethod
    def shape(schema):
        """Names and types of a JSON schema, without words and bounds."""
        if isinstance(schema, list):
            return [Foxglove.shape(each) for each in schema]
        if not isinstance(schema, dict):
            return schema
        if "properties" in schema:
            return {name: Foxglove.shape(each) for name, each in schema["properties"].items()}
        return [Foxglove.shape(schema["items"])] if "items" in schema else schema["type"]

    def test_poses_and_rings_are_in_the_schemas_of_its_panels(self):
        self.start_sim()
        self.run_tool("publish", "odom", "50ms")
        self.run_tool("publish", "ring", "50ms")
        url = self.serve()
        path = os.path.join(browser.node_modules(), "@foxglove", "schemas", "dist", "jsonschema", "index.js")
        theirs = json.loads(subprocess.run(["node", "-p", f"JSON.stringify(require({json.dumps(path)}))"], capture_output=True, text=True, check=True).stdout)
        for topic, name in (("/odometry/pose", "PoseInFrame"), ("/odometry/transform", "FrameTransform"), ("/proximity_ring/scan", "LaserScan")):
            seen = json.loads(self.client(url, topic, "2").communicate(timeout=90)[0])
            schema = next(channel["schema"] for channel in seen["channels"] if channel["topic"] == topic)
            self.assertEqual(schema["title"], f"foxglove.{name}")
            self.assertEqual(self.shape(schema), self.shape(theirs[name]), name)
            self.assertEqual(len(seen["messages"]), 2, topic)
            for message in seen["messages"]:
                jsonschema.validate(message["fields"], theirs[name])
                stamp = message["fields"]["timestamp"]
                self.assertEqual(stamp["sec"] * 10**9 + stamp["nsec"], int(message["time_ns"]))

    def test_it_publishes_and_reads_parameters(self):
        self.start_sim("--frozen")
        client = self.client(self.serve("--allow-commands"), "/motors", "2", "/motors", '{"x":0.1,"z":0}')
        seen = json.loads(client.communicate(timeout=90)[0])
        self.assertEqual(seen["messages"][0]["fields"], {"x": 0.1, "z": 0})
        self.assertEqual(seen["info"]["capabilities"], ["clientPublish", "parameters", "parametersSubscribe"])
        self.assertEqual(seen["parameters"]["parameters"][0]["name"], "/gyroscope/period_ms")
        self.assertEqual(seen["statuses"], [])


if __name__ == "__main__":
    harness.main()
