# SPDX-License-Identifier: GPL-3.0-or-later
"""What a project may say: one declaration for each setting, method, rule, mesher and file of input.

Input: words and numbers of a user. Output: the checked value, or a refusal with the allowed values. Keys of
the project file, properties of the panel and tables of the documents follow from here.
"""
