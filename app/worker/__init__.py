"""What the server and a worker process say to each other; all of it is plain, picklable data.

A run has a ticket. Orders about another ticket than the one at work are ignored, and so are
reports about a ticket that is no longer wanted: nothing depends on who is first.

    server -> worker   Run, Pace, Step, Seek, Watch, Park, Leave
    worker -> server   Ready, then per run: Taken, Begun, Frame, Begun, Reference | Unrivalled,
                       Progress*, Frame*, then End | Parked | Refused; Waiting whenever there is
                       nothing to do
    pool -> session    Begun, Reference, Unrivalled, Progress, Frame, End, Refused, Died; the rest
                       is internal

Only the second Begun has the closed form, which must not hold up the first picture. Begun,
Reference and Frame speak of one interface with friction, the one that is looked at; when another
is chosen all three are sent again. Its forces are per length, N/m, where the bound is known, and
tractions, Pa, where it depends on the pressure.
Every record of a run is in exactly one Progress, and so is every record of the full stage that is
iterated beside a run on separated bases; frames are only the newest. A run that was parked and
went on sends a complete Begun, Reference and a Frame again, and no record or End twice. Died alone
breaks this: what was sent of iterates under its ticket before is to be forgotten.

With the full linear stage, frames have no `bases`, and Progress neither `sizes` nor `beside`.
"""
