class Drawing:
    def __init__(self, stream, setting):
        self.stream = stream

    def add(self, block):
        pass

    def add_events(self, events, index):
        pass

    def finish(self, last):
        pass

    def layout_json(self):
        return "{}"
