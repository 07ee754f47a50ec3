#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""What guides.py reports of pages with one mistake each, and of one without."""

import unittest

import guides

SOUND = """# Page
`adit run RECORDING -o OUT` maps; `./dev test` tests.
```sh
adit run drive.mcap \\
  -o out    # a comment
./dev demo
```
```console
$ adit info out/map.adit
keyframes 12
...
```
```text
adit run RECORDING -o OUT
```
"""


class FakeProgram:
    """Knows `run` with -o and `info`; `info` prints one line."""

    def __init__(self):
        self.ran = []

    def help_of(self, words):
        return {("run",): "  -o,--output OUT", ("info",): "--json"}.get(words, "")

    def dev_verbs(self):
        return {"demo", "test"}

    def prepare(self, folder):
        self.ran.append("prepare")

    def run(self, command, folder):
        self.ran.append(command)
        if "fail" in command:
            raise guides.Problem("exit code 1")
        return "keyframes   7\nedges 3\n" if "info" in command else ""


class Guides(unittest.TestCase):
    def problems(self, text):
        self.program, self.used = FakeProgram(), set()
        return list(guides.check_page(self.program, "page.md", text, self.used))

    def expect(self, old, new, message):
        self.assertIn(old, SOUND)
        found = self.problems(SOUND.replace(old, new))
        self.assertEqual(len(found), 1, found)
        self.assertIn(message, found[0])

    def test_a_sound_page_runs_whole_and_has_no_problem(self):
        self.assertEqual(self.problems(SOUND), [])
        self.assertEqual(self.program.ran, ["prepare", "adit run drive.mcap -o out", "adit info out/map.adit"])
        self.assertEqual(self.used, {"./dev "})

    def test_a_page_that_makes_its_own_recording_waits_for_no_other(self):
        self.assertEqual(self.problems(SOUND.replace("drive.mcap", "walk.mcap")), [])
        self.assertEqual(self.program.ran[0], "adit run walk.mcap -o out")

    def test_pages_of_all_folders_are_run(self):
        pages = guides.pages()
        for page in ("README.md", "docs/running.md", "docs/guides/ros2_bag.md", "docs/theory/odometry.md"):
            self.assertIn(page, pages)

    def test_a_command_that_fails(self):
        self.expect("adit info out", "adit info fail", "page.md:8: adit info fail/map.adit: exit code 1")

    def test_what_is_not_printed(self):
        self.expect("keyframes 12", "keyframes: 12", "it did not print: keyframes: 12")

    def test_an_unmarked_block(self):
        self.expect("```text", "```", "is marked sh, console or (if it is none) text")

    def test_verbs_and_options_that_do_not_exist(self):
        self.expect("`adit run RECORDING -o OUT`", "`adit rnu`", "page.md:2: adit rnu: there is no command rnu")
        self.expect("`adit run RECORDING -o OUT`", "`adit run --out`", "adit run has no option --out")
        self.expect("./dev demo", "./dev dmeo", "./dev has no verb dmeo")
        self.expect("`./dev test`", "`./dev tset`", "./dev has no verb tset")
        self.expect("adit run RECORDING -o OUT\n```", "adit map RECORDING\n```", "there is no command map")

    def test_a_console_block_that_begins_with_output(self):
        with self.assertRaises(guides.Problem):
            guides.commands("console", ["keyframes 12"])


if __name__ == "__main__":
    unittest.main()
