"""A page's worker process: the run, those before it, and the pictures made of them.

What it and the server say to each other is plain, picklable data:

    server -> worker   Run, then Pace, Step, Seek about the run with their ticket; Watch and Ready
                       about the page
    worker -> server   a Picture for every Ready, as soon as there is something new; one at once
                       when a run is refused or breaks
    link -> session    these, and Died when the process is gone

Orders about another ticket than that of the run at work are ignored. Pictures carry only what
changed since the last, so each has to reach the browser, whatever its ticket; what a picture says
of buttons and sliders (`Facts`) counts for the run with its ticket alone. After `Ready(afresh)`,
and whenever the views that are seen change, a picture carries all of the page.

The first picture of a run is of its first iterate, before the reference and the closed form are
found; a run that follows a hand is shown when it has ended, or after `IN_A_HURRY`.
"""
