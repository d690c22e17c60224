"""In place of Blender's module."""


class Matrix:
    def __init__(self, rows):
        self.rows = rows
