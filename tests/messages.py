#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Compares the messages in the source with docs/troubleshooting.md: every message has an entry, and every entry a message.

Usage: messages.py [--list | --missing] [ROOT]. Exits 1 if a message has no entry, or an entry no message. --list prints
every message with its place; --missing only those without an entry.

A message is the text of an error, of a warning or of a reason that a user can see. It is found in the source as
- the arguments of an exception's constructor, or of a function in SINKS that takes such a text, or
- a statement with a literal of several words in a file of TEXTS, which puts reasons and findings into words.
What is not literal reads "…". An entry is a code span in the first column of a table of the page; "…" in it stands for
any text. An entry covers a message if its parts occur in the message in their order.
"""

import fnmatch
import pathlib
import re
import subprocess
import sys

PAGE = "docs/troubleshooting.md"
FOLDERS = ("engine/", "slam/", "tools/")
# Faults of the program itself, and exceptions of the C++ library without a text of ours. The page has one section for them.
INTERNAL = {"std::logic_error", "std::out_of_range", "std::bad_alloc", "py::error_already_set", "py::stop_iteration"}
# Functions whose arguments are the text of a message.
SINKS = {"fail", "refuse", "require", "problem", "notice", "handled", "left_out", "finding", "warn", "raise", "wrong",
         "renamed", "damaged", "ends_after", "note", "refuse_option", "Complaint", "Finding", "Refused", "Rejection"}
# The same in some folders alone: their names are common words.
LOCAL_SINKS = {"tools/inspection/": {"add"}}
# Lists of such texts: what is added to them is a message.
LISTS = {"warnings", "notices", "reasons", "findings", "notes"}
# A literal that begins so makes its statement a message.
MARKS = ("note: ", "note  ", "warning: ", "adit run: warning")
# And so does the stream that it goes to.
STREAMS = {"err", "err_", "cerr"}
# Files that put reasons, warnings and findings into words: each statement with a literal of
# several words is a message.
TEXTS = ("engine/self_test/self_test*.cpp", "slam/core/config.cpp", "tools/cli/command_line.cpp",
         "tools/cli/readable_error.cpp", "tools/clouds/cloud_columns.cpp", "tools/clouds/cloud_origin.cpp",
         "tools/clouds/*_reader.cpp", "tools/clouds/sweep_times.cpp", "tools/containers/*_cursor.cpp",
         "tools/containers/bag_reader.cpp", "tools/containers/compression.cpp", "tools/containers/declaration_error.cpp",
         "tools/containers/mcap_reader.cpp", "tools/containers/sqlite_database.cpp", "tools/evaluation/evaluate.cpp",
         "tools/export/align_report.cpp", "tools/export/export_job.cpp", "tools/inspection/clock_*.cpp",
         "tools/inspection/motion_check.cpp", "tools/inspection/unchecked.cpp", "tools/live/clock_check.cpp",
         "tools/live/disk_reserve.cpp", "tools/live/source_list.cpp", "tools/live/source_watch.cpp",
         "tools/map_database/map_database_check.cpp", "tools/map_database/map_recovery.cpp",
         "tools/map_database/map_salvage.cpp", "tools/map_database/map_schema.cpp",
         "tools/map_database/write_ahead_log.cpp", "tools/map_merge/merge_report.cpp",
         "tools/recordings/message_files.cpp", "tools/recordings/sweep_files.cpp", "tools/recordings/topic_survey.cpp",
         "tools/report/*_text.cpp", "tools/report/left_out.cpp", "tools/report/run_assessment.cpp",
         "tools/report/run_statistics.cpp", "tools/report/velocity_statistics.cpp", "tools/results/sweep_table.cpp",
         "tools/results/trajectory_io.cpp", "tools/run/run_judgement.cpp", "tools/run/run_mapping.cpp",
         "tools/setup/device_*.cpp", "tools/setup/sensor_topics.cpp", "tools/setup/static_transforms.cpp")
# What a database is asked is no message.
QUERY = re.compile(r"\s*(SELECT|INSERT|CREATE|UPDATE|DELETE|ALTER|PRAGMA|FROM|WHERE|BEGIN|DROP) ")
# Names of buffers, of records that are read, headings and lines of results, which those files have as well.
LABELS = re.compile(r"self-test|surface cells back|the (header|data) of a record|a chunk's counts|the bag's (header|index)"
                    r"|a (metadata|summary) record|the statistics record|(messages in all|(chunks|attachments) in the index)"
                    r"|the list of tables|session keyframes|sessions edges|overlap rms|adit device cache|[| ]*Vulkan"
                    r"|Options of every command|-V,--version|the numbers are read as they lie|point-to-plane|ndt-to-ndt"
                    r"|adit live (ros2|udp)|a stored submap of the map|the index of places$|table an index|ok is never used"
                    r"|the references between tables|the pages of the database|submaps their tables|the map's place in"
                    r"|m, roll|roll , pitch|qx , qy|world by")
# Files that name reasons by a word: what to_string() returns there is a message.
REASONS = ("slam/loops/loop_verification.cpp", "slam/registration/cloud_aligner.cpp", "slam/registration/registration.cpp",
           "slam/odometry/verdict.cpp")
NO_REASON = {"none", "unknown", "converged", "reliable", "full", "partial"}
# Messages for developers: of the reader of compiled shaders, which no file of a user reaches.
DEVELOPERS = ("engine/vulkan/spirv*",)
TOKEN = re.compile(r"""//[^\n]*|/\*.*?\*/|R"(?P<mark>\w*)\((?P<raw>.*?)\)(?P=mark)"|"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)+'"""
                   r"""|\d[\w.']*|[A-Za-z_]\w*|::|\s+|.""", re.DOTALL)
ESCAPES = {r"\n": " ", r"\t": " ", r"\"": '"', r"\\": "\\"}
SPAN = re.compile(r"`` (.+?) ``|`([^`]+)`")
ANY = "…"


class Token:
    def __init__(self, text, line, literal):
        self.text, self.line, self.literal = text, line, literal


def tokens(text):
    """Tokens without comments, includes and white space; literals without their quotes, neighbouring ones joined."""
    found, line = [], 1
    text = re.sub(r"^#.*$", "", text, flags=re.MULTILINE)
    for match in TOKEN.finditer(text):
        piece = match.group(0)
        if piece.startswith('"') or match.group("raw") is not None:
            inner = match.group("raw") if match.group("raw") is not None else piece[1:-1]
            inner = re.sub(r"\\.", lambda escape: ESCAPES.get(escape.group(0), ""), inner)
            if found and found[-1].literal:
                found[-1].text += inner
            else:
                found.append(Token(inner, line, True))
        elif not piece.isspace() and not piece.startswith(("//", "/*")):
            found.append(Token(piece, line, False))
        line += piece.count("\n")
    return found


def closing(found, opening):
    """Index behind the bracket that closes the one at `opening`."""
    depth = 0
    for index in range(opening, len(found)):
        if not found[index].literal:
            depth += (found[index].text in "([{") - (found[index].text in ")]}")
            if depth == 0:
                return index + 1
    return len(found)


def template(part):
    """The literals of some tokens in their order, with … for what lies between them."""
    text = ""
    for token in part:
        if token.literal:
            text += re.sub(r"\{[^{}]*\}", ANY, token.text)
        elif token.text == ",":
            text += f" {ANY} "
        elif token.text not in "+()" and token.text not in STREAMS:
            text += ANY
    text = re.sub(rf"[{ANY}\s]*{ANY}[{ANY}\s]*", lambda gap: f" {ANY} " if " " in gap.group(0) else ANY, text)
    return " ".join(text.split())


def prose(text):
    """Whether a literal is a message: three words at least."""
    words = re.findall(r"(?<![\w.])[A-Za-z][a-z']+(?![\w(]|\.\w)|\ba\b", text)
    return len(words) >= 3 and not QUERY.match(text)


def statements(found):
    """The parts of a source between semicolons and braces that hold a message, from its stream or first literal on."""
    part = []
    for token in [*found, Token(";", 0, False)]:
        if token.literal or token.text not in ";{}":
            if part or token.literal or token.text in STREAMS:
                part.append(token)
        else:
            if any(one.literal and prose(one.text) for one in part):
                yield part
            part = []


def is_exception(name):
    return name.endswith(("Error", "Damaged", "Stopped", "NotUnderstood", "NoSuchSystem", "OutOfMemory", "NoSuchDevice",
                          "DeviceLost", "NoGuess", "UnusableMetadata", "StoppedWhileCompiling", "_error",
                          "invalid_argument"))


def functions(found):
    """(first, last) of what stands between braces at the outermost level, namespaces aside."""
    index = 0
    while index < len(found):
        if not found[index].literal and found[index].text == "{":
            before = [token.text for token in found[max(0, index - 4):index]]
            if "namespace" in before or "class" in before or "struct" in before or "extern" in before:
                index += 1
                continue
            end = closing(found, index)
            yield index, end
            index = end
        else:
            index += 1


def reasons(found):
    """(line, word) of each reason that to_string() returns."""
    for index, token in enumerate(found[:-1]):
        if token.literal and found[index - 1].text == "return" and found[index + 1].text == ";" \
                and token.text not in NO_REASON:
            yield token.line, token.text


def calls(path, found):
    """(index, first token of the name, arguments) of each call that takes the text of a message."""
    sinks = SINKS.union(*(names for folder, names in LOCAL_SINKS.items() if path.startswith(folder)))
    for index, token in enumerate(found[:-1]):
        if token.literal or found[index + 1].text not in ("(", "{") or found[index + 1].literal:
            continue
        first = index
        while first >= 2 and found[first - 1].text == "::":
            first -= 2
        if "".join(one.text for one in found[first:index + 1]) in INTERNAL:
            continue
        listed = token.text in ("push_back", "emplace_back") and found[index - 2].text.rstrip("_") in LISTS
        part = found[index + 2:closing(found, index + 1) - 1]
        if listed or is_finding(token, part) or token.text in sinks or is_exception(token.text):
            yield index, first, part


def is_finding(token, part):
    """A finding of `adit inspect` is written {Severity::problem, "its kind", ...}."""
    return token.text in ("return", "push_back", "(", "=", "{") and part and part[0].text == "Severity"


def of_calls(path, found):
    """(line, tokens) of each message that is the argument of a call."""
    bodies = list(functions(found))
    for index, first, part in calls(path, found):
        thrown = first > 0 and found[first - 1].text == "throw"
        if any(one.literal and prose(one.text) for one in part) or is_finding(found[index], part) or \
                thrown and any(one.literal and " " in one.text.strip() for one in part):
            yield found[index].line, part
        elif thrown:  # what was put into words before, in the same function
            body = next((body for body in bodies if body[0] <= index < body[1]), (index, index))
            yield from ((text[0].line, text) for text in statements(found[body[0]:body[1]]))


def messages_of(path, text):
    """(line, template) of each message of a source, each once."""
    found = tokens(text)
    texts, done = [], {}
    if any(fnmatch.fnmatch(path, pattern) for pattern in TEXTS):
        texts = [(part[0].line, template(part)) for part in statements(found)]
        texts = [one for one in texts if not LABELS.match(re.sub(rf"[{ANY}* ]+", " ", one[1]).strip())]
    for line, part in of_calls(path, found):
        done.setdefault(line, template(part))
    for part in statements(found):
        marked = any(one.literal and one.text.startswith(MARKS) for one in part) or part[0].text in STREAMS
        if marked and not done.keys() & {one.line for one in part}:
            done[part[0].line] = template(part)
    # What a statement of a file of texts has whole is not counted twice.
    others = [one for one in done.items() if not any(one[1].strip(ANY + " ") in words for _, words in texts)]
    named = list(reasons(found)) if path in REASONS else []
    return sorted({words: (line, words) for line, words in reversed(texts + named + others)}.values())


def messages(files):
    """(place, template) of each message of a tree given as {path: text}."""
    for path, text in sorted(files.items()):
        if path.startswith(FOLDERS) and path.endswith((".cpp", ".hpp")) and \
                not any(fnmatch.fnmatch(path, pattern) for pattern in DEVELOPERS):
            for line, words in messages_of(path, text):
                if re.search("[a-z]", words):
                    yield f"{path}:{line}", words


def entries(page):
    """(line, quoted message) of each code span in the first column of the page's tables."""
    for number, line in enumerate(page.split("\n"), 1):
        if line.startswith("| "):
            for match in SPAN.finditer(re.split(r"(?<!\\) \| ", line[2:])[0]):
                yield number, (match.group(1) or match.group(2)).replace("\\|", "|")


def covers(entry, words):
    """Whether the parts of an entry occur in a message in their order; one word is a kind, which begins the message."""
    if " " not in entry.strip() and ANY not in entry:
        return re.match(rf"[{ANY} ]*{re.escape(entry)}(?![\w-])", words) is not None
    begin = 0
    for part in filter(None, (" ".join(part.split()) for part in entry.split(ANY))):
        begin = words.find(part, begin)
        if begin < 0:
            return False
        begin += len(part)
    return True


def check(files):
    """Problems, the messages, and those without an entry."""
    listed = list(entries(files.get(PAGE, "")))
    found = list(messages(files))
    used, missing = set(), []
    for place, words in found:
        by = [entry for entry in listed if covers(entry[1], words)]
        used.update(by)
        if not by:
            missing.append((place, words))
    problems = [f"{place}: {PAGE} has no entry for: {words}" for place, words in missing]
    problems += [f"{PAGE}:{entry[0]}: no message of the source has: {entry[1]}" for entry in listed if entry not in used]
    problems += [f"{PAGE}:{line}: too general for an entry: {entry}" for line, entry in listed
                 if " " in entry and len(re.sub(rf"[{ANY}\s]", "", entry)) < 8]
    return problems, found, missing


def stale(files):
    """Patterns of this script that no file has any more, so that what they found would be missed in silence."""
    return [f"tests/messages.py: no file is called {pattern}" for pattern in TEXTS + REASONS + DEVELOPERS
            if not any(fnmatch.fnmatch(path, pattern) for path in files)]


def read_tree(root):
    listing = subprocess.run(["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                             check=True, capture_output=True).stdout.decode()
    return {path: (root / path).read_text() for path in listing.split("\0")
            if (path.startswith(FOLDERS) and path.endswith((".cpp", ".hpp")) or path == PAGE) and (root / path).is_file()}


def main():
    options = [argument for argument in sys.argv[1:] if argument.startswith("--")]
    roots = [argument for argument in sys.argv[1:] if not argument.startswith("--")]
    files = read_tree(pathlib.Path(roots[0] if roots else pathlib.Path(__file__).parent.parent))
    problems, found, missing = check(files)
    problems += stale(files)
    if options:
        for place, words in found if "--list" in options else missing:
            print(f"{place}: {words}")
    else:
        print("\n".join(problems), end="\n" if problems else "")
    print(f"messages: {len(found)} in the source, {len(found) - len(missing)} with an entry, {len(problems)} problems",
          file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
