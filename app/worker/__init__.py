"""What the server and a page's worker process say to each other: plain, picklable data.

A run has a ticket. Orders about another ticket than the one at work are ignored, and so are
reports about a ticket that is no longer wanted: nothing depends on who is first.

    server -> worker   Run, Pace, Step, Seek, Watch
    worker -> server   per run: Taken, Begun, Frame, Begun, Reference | Unrivalled, Progress*,
                       Frame*, then End | Refused; Waiting whenever there is nothing to do
    link -> session    all of these, and Died when the process is gone

Only the second Begun has the closed form, which must not hold up the first picture. Begun,
Reference and Frame speak of one interface with friction, the one that is looked at; when another
is chosen all three are sent again. Its forces are per length, N/m, where the bound is known, and
tractions, Pa, where it depends on the pressure.
Every record of a run is in exactly one Progress, and so is every record of the full stage that is
iterated beside a run on separated bases; frames are only the newest.

With the full linear stage, frames have no `bases`, and Progress neither `sizes` nor `beside`.
"""
