"""Forms of remarks: exclamations, reports of earlier moves, and the subjects with which statements begin."""

from __future__ import annotations

import re

SUBJECT = (
    r"i|i['’]?m|i['’]?ve|i['’]?ll|i['’]?d|we['’]re|we['’]?ve|he|he['’]?s|he['’]?d|she|she['’]s|they|they['’]?re|they['’]?ve|it['’]s|that['’]?s"
    r"|one (?:seems|appears)"
    r"|there['’]?s|there (?:is|are|was|should|seems)|someone|somebody|something|nobody|everyone|everybody|some(?:one"
    r"|body|thing)['’]?s|nobody['’]?s"
    r"|(?:my|our) (?:boss|mum|dad|wife|husband|mate|lad|lads|old|eyes|sister|brother|kids|manager)|(?:my|our) \w+ "
    r"(?:has|have|is|are|was|were|says?|said|thinks?|reckons?|swears?|keeps?|loves?|likes?|just)"
    r"|(?:yesterday|earlier|last (?:night|week)|today|tonight) (?:it|he|she|they|we|i)"
    r"|(?:an?|one of (?:the|our|my)|(?:the|our|my) \w+) \w+ "
    r"(?:says|said|thinks|thought|reckons|swears|told|is asking|are asking|is waiting)"
)
"""Words with which a statement begins, even if it is not separated by punctuation."""

NOUN_SUBJECT = (
    r"the (?:boss|gaffer|manager|weather|lads?|sun|\w+ shift)|people"
    r"|the \w+ (?:say|says|think|thinks|reckon|reckons|swear|swears)"
    r"|(?:the )?\w+ (?:is|are) asking|\w+ (?:says|reckons)|only the [\w' ]+ (?:is|are)"
)
"""Words with which a statement begins if it is separated by punctuation."""

REFUSAL = re.compile(
    r"\b(?:no|nah|nope|wait|hang on|hold on|stop|actually|instead|undo|never ?mind|forget|not|before|leave|skip|don['’]?t)\b",
    re.IGNORECASE,
)
"""Words that may take back what was said, or say when not to do it."""

EXCLAMATION = re.compile(
    r"(?:(?:oh|ah|well|my|gosh|goodness|now|and|just) )*(?:how \w+|what an? [\w ]+"
    r"|(?:is|are)n['’]?t (?:it|that|he|she|they) [\w ]+"
    r"|(?:lovely|beautiful|nice|gorgeous|terrible"
    r"|dreadful|horrible|awful|rotten|cold|busy|quiet|funny|miserable|glorious|proper|typical) [\w ]+"
    r"|hear(?:ing)? (?:reports?|complaints?) [\w ]+|(?:had|got|getting|having) (?:an? )?(?:reports?|complaints?|calls?|word|news)"
    r"\b[\w' ]*|(?:good )?(?:morning|afternoon|evening)(?: \w+)?|hiya|hello(?: \w+){0,2}|hi(?: \w+){0,2}"
    r"|(?:many |so many )?thanks\b[\w' ]*|thank you\b[\w' ]*|bless (?:him|her|them|you)|as (?:usual|ever|always)"
    r"|(?:i )?(?:think|reckon|bet|guess|suspect|believe|fear) (?:its?|it['’]s|he|she|they|that|the)\b[\w' ]*"
    r"|(?:i )?(?:swear|promise|know|remember|thought|hope|doubt|make it) (?:i|he|she|it|they|we|the|that|\w+)\b[\w' ]*"
    r"|(?:i |we )?(?:need|want) (?:it|this|them|that) for [\w ]+"
    r"|(?:i |we )?(?:need|want|have) to (?:know|be sure|make sure) (?:that )?(?:i|we|it|they|he|she)\b[\w' ]*"
    r"|(?:just )?(?:wondering|curious|checking|hoping) (?:if|whether|that)? ?(?:i|we|they|he|she|it)\b[\w' ]*"
    r"|(?:first|second|third) (?:time|day|night|week|shift)\b[\w' ]*"
    r"|(?:just )?(?:trying|hoping|doing|writing|filling|working|waiting|getting|making|thinking|planning|preparing"
    r"|sorting)\b[\w' ]*"
    r"|looks? (?:an? (?:bit|little)|like|as|to be)\b[\w' ]*"
    r"|(?:the )?(?:sun|wind|light|glare|rain|dust|fog|mist|snow)s? \w+ing\b[\w' ]*"
    r"|(?:i['’]?m|i am) (?:ever |so |very |terribly )*sorry\b[\w' ]*|sorry\b[\w' ]*|forgive [\w' ]+|pardon me\b[\w' ]*)",
    re.IGNORECASE,
)
"""Remarks that are not statements: "how romantic", "lovely day for it", "many thanks from all of us"."""

EXEMPT = re.compile(
    r"(?:oh |well |just )*look at (?:that|him|her|them|those)|(?:focus|end stop|backlash|range|function|bearing|speed"
    r"|servo|motor|drive|limit|limit switch|end switch) (?:test|check)"
    r"|(?:just )?(?:checking|testing|measuring|verifying|watching) (?:the |its |for )?(?:(?:pan|tilt|zoom|focus|tracking) )?"
    r"(?:smoothness|speed|accuracy|performance|response|backlash|jitter|lag)"
    r"|the [\w ]+? (?:is|are)(?: not|n['’]t)(?: \w+){0,2} (?:in|into) (?:the )?(?:frame|picture|view|shot)"
    r"|(?!the )[a-z]+(?: [a-z]+)? in (?:the )?(?:shot|way|picture|view)"
    r"|(?:i )?(?:don't|do not) care\b[\w' ]*"
    r"|the (?:lower|upper|left|right|bottom|top) (?:part|half|side|edge) of (?:the|my) (?:picture|screen|view|frame) "
    r"is (?:nothing but|all"
    r"|just|only|mostly|full of) [\w ]+"
    r"|can you believe (?:it|that)|(?:oh |well )*(?:is|are)n['’]t (?:it|that|he|she|they) \w+"
    r"|(?:i|we) (?:really |quite |do )?(?:like|liked|love|loved) (?:this|that) one(?: (?:a lot|very much|too))?"
    r"|(?:this|that) one(?:['’]s| is| looks) (?:\w+ )?(?:nice|lovely|good|great|pretty|beautiful|interesting|cool|funny)"
    r"|the [a-z]+(?: [a-z]+)? (?:is|are) (?:still |all |too |so |completely |partly |half |mostly )*"
    r"(?:hidden|covered|blocked|obscured|cut off|out of (?:view|sight|frame|shot|(?:the )?picture)|dark|blurred|blurry|tiny|fuzzy)"
    r"(?: (?:on|at|along) (?:both sides|either side|one side|the (?:edges?|top|bottom|sides?)))?",
    re.IGNORECASE,
)
"""Remarks with words that would ask for something in other texts, such as "one" or a word of a preset's name."""

RETURN = re.compile(
    r"(?:(?:please|ok|okay|no|now|just),? )*(?:(?:go|come|move|turn|take me|take us) )?"
    r"(?:back\b|undo\b|return\b|(?:to )?the (?:previous|last) view)",
    re.IGNORECASE,
)
"""The beginning of a command to go back to an earlier view."""

RETURN_REASON = re.compile(
    r"(?:that|it|that one|that view|the (?:other|last|previous|first) (?:one|view)) "
    r"(?:was|is|looked) (?:much |far |a lot |a bit |way )?"
    r"(?:better|nicer|clearer|prettier)"
    r"|(?:i|we) (?:really |quite |do )?(?:like|liked|love|loved|prefer|preferred) (?:that|it)(?: (?:one|view))?"
    r"(?: (?:a lot |much )?(?:better|best|more))?",
    re.IGNORECASE,
)
"""Reasons for going back, which in other places may ask for something else: "that was better"."""


def gives_reason_for_return(said: str, reason: str) -> bool:
    """Return whether a text goes back to an earlier view, and the words after it only say that it was better."""
    return RETURN.match(said.strip()) is not None and RETURN_REASON.fullmatch(reason.strip(" ,.;!")) is not None


_PAST = r"(?:panned|tilted|zoomed|swung|turned|moved|swivelled|rotated|pointed|aimed|went|used to (?:pan|tilt|zoom|turn|move))"
_NO_REQUEST = r"(?!.*\b(?:please|should|must|shall|ought|want|need|can you|could you|would you|let['’]?s)\b)"
REPORT = re.compile(
    rf"{_NO_REQUEST}(?:"
    r"(?:(?:earlier|yesterday|last (?:night|shift|time|week)|this morning|before|according to the log),? )?"
    rf"(?:i|we|he|she|they|someone|somebody|(?:my|the|our|last) \w+|you just|(?-i:[A-Z]\w+)(?: (?:said|says|told me) "
    rf"(?:that )?(?:he|she|they|it))?)"
    rf" (?:had |has |have |just |already )*{_PAST}\b.*"
    r"|(?:i remember|last shift reported|(?-i:[A-Z]\w+) mentioned) (?:panning|tilting|zooming|turning|moving)\b.*"
    r"|(?:earlier|yesterday|last (?:night|shift|week)),? the camera was (?:panned|tilted|zoomed|turned|moved)\b.*"
    r"|(?!.*\b(?:camera|lens|view|picture|you) (?:is|are)\b)(?:the |a |my |our |his |that |some )?[\w]+(?: \w+)?"
    r"(?:['’]s| is| are| was| were|"
    r" keeps?) (?:really |still |just |now |always )?\w+ing\b.*)",
    re.IGNORECASE,
)
"""Reports of earlier moves, and of what things do: "Dave panned left 20", "the crane is turning left again". They do not
ask for the directions and amounts that they mention."""
