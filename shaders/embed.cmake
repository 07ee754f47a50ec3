# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# Writes the words of the SPIR-V file INPUT to OUTPUT as a list of C++ literals, eight to a line.
file(READ ${INPUT} bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${bytes}")
string(REPEAT "..........," 8 line)
string(REGEX REPLACE "(${line})" "\\1\n" words "${words}")
file(WRITE ${OUTPUT} "${words}\n")
