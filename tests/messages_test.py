#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""What messages.py finds in a source, and what it reports of a page that lacks an entry or has one too many."""

import unittest

import messages

SOURCE = """#include "adit/a/b.hpp"
// throw InputError("a comment is no message");
InputError ends_after(int n) { return InputError(file, "", "it ends after " + std::to_string(n) + " lines", "Copy it again"); }
void read() {
  if (empty) {
    throw InputError(path_, place, fmt::format("the file of {} bytes "
                                               "is empty", size), "Record anew");
  }
  const std::string text = "the sensor does not answer";
  throw OutputError(text);
}
"""
PAGE = """| message | cause | what to do |
|---|---|---|
| `it ends after` | cut off | copy it |
| `the file of … is empty`, `the sensor does not answer` | nothing sent | see the cable |
"""


class Messages(unittest.TestCase):
    def problems(self, source=SOURCE, page=PAGE, path="tools/a/b.cpp"):
        return messages.check({path: source, messages.PAGE: page})[0]

    def expect(self, message, **changed):
        problems = self.problems(**changed)
        self.assertEqual(len(problems), 1, problems)
        self.assertIn(message, problems[0])

    def test_a_page_with_all_messages_has_no_problem(self):
        self.assertEqual(self.problems(), [])
        self.assertEqual(len(messages.check({"tools/a/b.cpp": SOURCE, messages.PAGE: PAGE})[1]), 3)

    def test_a_message_without_an_entry_is_found(self):
        self.expect("tools/a/b.cpp:6: docs/troubleshooting.md has no entry for: … the file of … bytes is empty … Record anew",
                    page=PAGE.replace("`the file of … is empty`, ", ""))

    def test_a_text_that_is_thrown_later_is_found(self):
        self.expect("the sensor does not answer", page=PAGE.replace(", `the sensor does not answer`", ""))

    def test_an_entry_without_a_message_is_found(self):
        self.expect("no message of the source has: the sensor is hot", page=PAGE + "| `the sensor is hot` | sun | shade |\n")

    def test_an_entry_that_says_too_little_is_found(self):
        self.expect("too general for an entry: it ends", page=PAGE.replace("`it ends after`", "`it ends`"))

    def test_the_parts_of_an_entry_are_in_order(self):
        self.assertTrue(messages.covers("the file … is empty", "the file of … bytes is empty"))
        self.assertFalse(messages.covers("is empty … the file", "the file of … bytes is empty"))

    def test_one_word_is_a_kind_and_begins_the_message(self):
        self.assertTrue(messages.covers("clock_leap", "… clock_leap … its clock leaps"))
        self.assertTrue(messages.covers("lost", "lost"))
        self.assertFalse(messages.covers("lost", "the device was lost"))
        self.assertFalse(messages.covers("clock", "clock_leap … its clock leaps"))

    def test_kinds_of_findings_warnings_and_notes_are_messages(self):
        source = ('Finding f() { return {Severity::problem, "blocked", name, found, effect}; }\n'
                  'void g() { warnings.push_back("the two are the same");\n  err << "adit: that is odd here" << n; }\n'
                  'void h() { out << "note: nothing was written\\n"; out << "this is a line of a report"; }\n')
        self.assertEqual([words.strip("… ") for _, words in messages.messages({"tools/a.cpp": source})],
                         ["blocked", "the two are the same", "adit: that is odd here", "note: nothing was written"])

    def test_statements_of_a_file_of_texts_are_messages(self):
        source = 'std::string f() { return std::string("the IMU was lost for ") + n + " s"; }\n'
        self.assertEqual([words for _, words in messages.messages({"tools/report/imu_text.cpp": source})],
                         ["the IMU was lost for … s"])
        self.assertEqual(list(messages.messages({"tools/report/imu.cpp": source})), [])

    def test_a_pattern_that_no_file_has_is_found(self):
        self.assertEqual(len(messages.stale({})), len(messages.TEXTS + messages.REASONS + messages.DEVELOPERS))

    def test_faults_of_the_program_are_no_messages(self):
        self.assertEqual(self.problems(source=SOURCE + 'void f() { throw std::logic_error("a kernel has no name"); }\n'), [])

    def test_only_the_first_column_of_a_table_has_entries(self):
        self.assertEqual([entry for _, entry in messages.entries("| `a b` and `c` | `d` |\ntext `e`\n")], ["a b", "c"])


if __name__ == "__main__":
    unittest.main()
