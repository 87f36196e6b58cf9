"""Patterns that take remarks out of the text of an instruction: greetings, forms of address, and phrases that ask for nothing."""

from __future__ import annotations

_VOCATIVES = (
    "driver|sunshine|sweetie|sweetheart|honey|hon|love|darling|pet|duck|lad|lads|guys|folks|gentlemen|ladies|captain|skipper|friend"
    "|my friend|son|bro|bruv|dude|jeeves|james|fella|fellas|champ|big man|mind|mind you|my love|petal|treacle"
)
_GREETINGS = "hey|hi|hello|ok|okay|morning|evening|thanks|cheers|listen|look"
_NUMBER = r"(?:\d+|two|three|four|five|six|seven|eight|nine|ten|twelve|fifteen|twenty|thirty|fifty)"
_ALL = r"(?:it|everything|things|all|that|it all|the (?:camera|view|picture))"
_NOTHING_ELSE = (
    rf"don['’]?t bother|(?:just )?(?:leave|keep) {_ALL}(?: be| alone| (?:just |exactly )?(?:as|how|where|the way) "
    r"(?:it|they|things) (?:is|are)(?: now)?)?|never mind|forget (?:about )?it|no worries|that['’]s fine|fine"
    r"|nothing(?: to do| needs doing)?"
)

_FOLLOWING = (
    r"(?:(?:follow|track|trail|tail|shadow|watch)\w*|stay(?:ing)? (?:on|with)"
    r"|keep(?:ing)? (?:on|with|an eye|your eye|eyes|the camera on))"
)
_WAY = "(?:out|in|off|away|past|by|along|around|round|about|across|over|through|up|down|home|back|to|into|onto|from|towards)"

REMARKS = (
    (r",? (?:and )?i(?: just)?(?: want| need|['’]d like| would like) to show (?:him|her|them|(?:my|our) \w+)\W*$", ""),
    (rf"^([^,]*),\s*(?:{_VOCATIVES})(?=\s*[,.!?;]|\s*$)", r"\1"),
    (r",\s*(?:grand|lovely|perfect|ta|cheers)\s*[.!]?$", ""),
    (r"^righto[,.!]? ", ""),
    (r",? if (?:it|you|that|the camera) (?:can|could) (?:do|manage) (?:that|it|this)(?=[,.]|$)", ""),
    (
        r"(?<!head)(?<!make)(?<!aim)(?<!look)(?<!search)[,.;]? (?:both |all (?:of them )?|just |(?:it|that|this)"
        r"(?:['’]s| is) |i (?:need|want) (?:it|them|that) "
        r"|need (?:it|them) )?"
        r"for (?:the|my|our) (?:(?:morning|evening|night|shift|daily|hourly|weekly|monthly|stock|incident|site|safety|fire|duty) )?"
        r"(?:sheet|report|log|file|files|records?|logbook|book|office|inventory|audit|insurance|handover|muster|survey)\W*$",
        "",
    ),
    (
        r"[,.;] (?:(?:i|we) )?(?:just )?(?:need|want) the (?:exact )?(?:numbers?|figures?|counts?|totals?|tally|result|answer)"
        r"(?: (?:for|in) (?:the|my|our) [\w ]{2,40})?\W*$",
        "",
    ),
    (r"[,.;] (?:right |ok |okay |and )?that(?:['’]s| is) (?:me|us) (?:finished|done|off)(?: for (?:the |to)?\w+)?\W*$", ""),
    (r"[,.;] (?:just )?(?:checking|testing|measuring|listening to|looking at) (?:the|its) [\w ]{2,30} for [\w ]{2,30}\W*$", ""),
    (r", i swear(?: to god)?(?=,)", ""),
    (r"\bi should like\b", "i would like"),
    (r"^aye,? (?:right,? )?", ""),
    (r"\b(can|will|would|could|do|did|have|are|if) yer\b", r"\1 you"),
    (r"\bth['’](?=[a-z])", "the "),
    (r"\bur (?=look|point|aim)", "you're "),
    (
        r"(\ball the way(?: a?round)?(?: to the)? (?:left|right|up|down|in|out)),? (?:till|until) it (?:stops|hits the stop|will "
        r"not go any further)(?: like)?",
        r"\1",
    ),
    (r"\b(?:make|do) (?:the|my|your|a) rounds?(?:[.:;]|,(?= (?:at|for|in|on) )| and) (?:please )?(?=.*\b(?:each|every) )", ""),
    (r"\bshow (?:our|the|my|these) (?:guests?|visitors?|customers?|boss|manager|board) (?=the|that)", "show me "),
    (r",? wherever (?:he|she|it|they) goes?\b", ""),
    (r"^back to home\b", "back home"),
    (r"^(?:right|okay|ok|well),? that(?:['’]s| is) (?:me|us) (?:finished|done|off)(?: for the (?:day|night|shift))?[,.] ", ""),
    (r"\b(frame|centre|center) (the [\w ]+?) (?:nicely|neatly|well|properly)\b", r"zoom in on \2"),
    (r"^(find me [\w ]+?) again\b", r"\1"),
    (r" while the (?:light|sun|weather)(?:['’]s| is) [\w ]+\W*$", ""),
    (rf"\b(if|when|should|in case)\b(.+?)[;,.]\s*(?:if not|otherwise),? (?:{_NOTHING_ELSE})\s*[.!]*$", r"\1\2"),
    (
        r"\b(?:now |please |just )?do (?:me|us|an? [\w ]{2,20}?) (?:a|one) (?:quick |small |little |big )?favou?r"
        r"(?:,? and|[,:.])? ",
        "",
    ),
    (r"^(?:please )?(?:settle|help me settle) an? (?:argument|bet|debate|dispute)\b[^.?!:]*[.?!:] ", ""),
    (
        r"^(?:now |right |ok |so )*(?:let['’]?s|let us|let me|i want to|i['’]d like to) see what(?:['’]s| is) behind "
        r"(?:us|me|you|the camera)[,.;]? (?:so )?(?=(?:please )?(?:turn|spin|swing|rotate)\b)",
        "",
    ),
    (
        r"\b(?:i|we) (?:just )?(?:want|wanted|need|would like|['’]d like) to see the whole (?:lot|thing|place|yard|site|picture),? "
        r"(?:so )?(?:go ahead and )?(?=zoom out)",
        "",
    ),
    (
        r"^i(?:['’]d| would) like to know how (?:busy|full|quiet|crowded|things)\b[^,;.]*[,;] so (?=(?:please )?(?:go"
        r"|count|take|check"
        r"|visit|tour|sweep)\b)",
        "",
    ),
    (r"(?<=\w)[,.;]? (?:can|could|would|will) (?:you|u) count (?:both|them both|them all|all of them)(?: for (?:me|us))?\W*$", ""),
    (r"^(afternoon|morning|evening), ", ""),
    (
        r",? for (?:the|my|our|an?|this) (?:[\w-]+ ){0,2}(?:check|tests?|survey|inspection|handover|series|trial|demo"
        r"|meeting|newsletter"
        r"|website|briefing|presentation)\W*$",
        "",
    ),
    (
        r",? before (?:i|we) (?:can )?(?:begin|start|sign|hand|lock|close|clock|knock|file|submit|send|report|finish"
        r"|order|ring|call"
        r"|phone|set off|leave)\b(?!.*\b(?:pan|tilt|zoom|turn|mov|count|photo|picture))[^,.;]*\W*$",
        "",
    ),
    (r"^(?:oh,? )?(?:is|are|was)n['’]t (?:it|that|this|the|they)\b[^?.!,]*[!.,] (?=\w)", ""),
    (
        r"^(?:if i may ask for|i have|i['’]ve got|just) (?:one|two|three|a couple of|a few) (?:small |quick |little )?(?:things?"
        r"|requests?|questions?|favou?rs?)[,:.] ",
        "",
    ),
    (r"^(?:pardon|forgive|excuse) me for \w+ing,? (?:but )?", ""),
    (
        r"(?<=\w)(?:,| and| because| as| so)+ (?:i|we) (?:want|need|have|ought) to show (?:it |them )?(?:to )?"
        r"(?:my|our|his|her|their|the) (?:\w+(?:or|er|man|woman|ist|son)|boss|lads?|police|council|chief|wife|kids?|mum|dad)\W*$",
        "",
    ),
    (
        r"(\bdon['’]?t (?:touch|move|change) the \w+), (?:that|it)['’]?s (?:fine|ok|okay|good|perfect) (?:where|as|how) it is\b",
        r"\1",
    ),
    (
        r"\b((?:photo|picture|pic|shot|snap|still)\b.*?) for my (?:sister|brother|wife|husband|mum|dad|mother|father|son|daughter"
        r"|grandson|granddaughter|friend|colleague|neighbou?r)\W*$",
        r"\1",
    ),
    (r"\b(photo|picture|pic|shot|snap|still) of it all\b", r"\1"),
    (r",? as (?:two|three|four|five|six|\d|separate)(?: separate| individual| distinct)? (?:moves|steps|movements)\b", ""),
    (
        r"^(?:there(?:['’]s| is)|i (?:can )?see|we(?:['’]ve| have)(?: got)?) (an? [\w ]+?),? (?:who|that"
        r"|which)\b[^,.;]*[,.;] (?:so )?"
        r"(?:please |can you |could you |would you )*(follow|track|zoom in on|keep an eye on) (?:him|her|it|them)\b"
        r"(?: with the camera)?",
        r"\2 \1",
    ),
    (
        r"(?:^|,? )if (?:it|that)(?: is|['’]s| is not|['’]s not| isn['’]t)(?: not)? (?:an?|too much|any|no) (?:bother|trouble"
        r"|problem|hassle|inconvenience)\b",
        "",
    ),
    (r",? should be (?:about |around )?(?:\d+|two|three|four|five|six|seven|eight|nine|ten|a dozen)\W*$", ""),
    (r"[.?!] that (?:should|ought to|will) (?:put|bring|get|give|show|do)\b[^?!]*$", ""),
    (r", that (?:should|ought to|will) (?:put|bring|get) (?:the|my|our|his|her|their) [a-z ]+\W*$", ""),
    (
        r"\bfor, (?:i dunno|i don['’]?t know|i do not know|oh|say|let['’]?s say|shall we say|what|maybe|like|um|er),? "
        rf"(?=(?:\d+|an?|{_NUMBER[3:-1]}|\w+ty(?:-\w+)?) )",
        "for ",
    ),
    (r"[;,.] (?:both|they|these|all) (?:are|is) for (?:the|my|our)\b[^;.]*\W*$", ""),
    (
        r",? before (?:the |my |our )?(?:next |morning |evening |night |day )?(?:hand ?over|shift change|lunch(?:time)?|breakfast"
        r"|dinner|tea|closing(?: time)?|opening(?: time)?|kick-?off|curfew|dark|dusk|nightfall|midnight|noon|midday)\W*$",
        "",
    ),
    (
        r"[.?!,;] (?:i|we|he|she|they|(?:the|my|our) (?:\w+ )?\w+) (?:just )?(?:wants?|needs?|would like) to (?:know|decide|see) "
        r"(?:where|what|when|who|whether|which(?: \w+){0,2}) to (?!the\b|my\b|our\b|a\b)\w+\b[^.;?!,]*\W*$",
        "",
    ),
    (
        r"\b(?:my|the|our) [\w'’ ]{2,30}? (?:says?|said|wants (?:me|you)|told me|tells me|asks (?:me|you)|asked me) to "
        r"(?=(?:pan|tilt|zoom|point|turn|go|take|count|move|look|aim)\b)",
        "",
    ),
    (r",? so (?:could|can|would|will) you (?:please )?do (?:that|it)(?: for me)?(?: please)?\W*$", ""),
    (r"^i(?:['’]d| would) like to compare [^,.;]*[,.;] so ", ""),
    (r"^can we do a (?:little |quick |short )?(?:tour|round|lap)\? ", ""),
    (
        r"[.?!,;] (?:i |we )?(?:just )?(?:want|need|like|would like) to know (?:should|which|where|what) (?:i|we|he"
        r"|she|they|line|way)\b[^?.!]*\W*$",
        "",
    ),
    (
        r"[.?!] (?:the )?\w+ (?:wants|needs|would like) (?:the|a|some) (?:figures?|numbers?|report|list|result|answer|total)s?\W*$",
        ".",
    ),
    (
        r"(?<=\w)[,.;?!] (?:customer|client|visitor|driver|guest|neighbour|police|manager)s? (?:request|complaining"
        r"|waiting|asking|shouting|ringing|complaint|orders?)\b[^?.]*\W*$",
        "",
    ),
    (r"[?.] i (?:ought to|should) (?:know|remember|have known)\b[^?]*$", "?"),
    (
        r"\b(?:i|we) (?:need|want|have|would like) to see the (?:whole|complete|entire|full) [\w ]+?(?: for "
        r"[\w ]+?)?, (?:so )?(?:please )?"
        r"(?=zoom (?:all the way )?out)",
        "",
    ),
    (
        r"(\ball the way[\w ]*?|\bas far as it goes),? (?:till|until|so(?: that)?) (?:we|i|you) (?:get|have|can see"
        r"|see) the (?:whole|entire) \w+(?: in (?:it|view|shot|the picture))?",
        r"\1",
    ),
    (r"^before i (?:leave|go|start)\b[^,.;]*? i (?:must|need to|have to|want to) know ", "tell me "),
    (r"^(?:nobody|no one) (?:is|are) (?:allowed )?to [^.;]*[.;] ", ""),
    (r",? for (?:job|case|incident|ticket|order|report|ref|reference|task|file) (?:no\.? |number |#)?[\w-]*\d[\w-]*\b", ""),
    (r"^i(?:['’]ve| have)? (?:got|have|need) to (?:zoom|run|dash|pop|nip|head|go|shoot) off\b[^,.;]*[,.;] ", ""),
    (r", not (?:after(?:wards)?|before|during)\W*$", ""),
    (r", which (?:i|we) (?:seem|appear|believe|think|have|had|was|am|were)\b[^?.;]*", ""),
    (
        r"(?<=\w), where (?:the|my|our|i|we|they|he|she) [\w' ]+? (?:used to|is|was|are|were|has|had|lies|lay|stood"
        r"|stands|lives)\b[^?.;,]*[.!]*$",
        "",
    ),
    (r",? (?:and )?hold(?: it| there| position| steady)?\W*$", ""),
    (r",? there should be (?:about |around |at least )?(?:\d+|\w+)\W*$", ""),
    (
        r"^before (?:i|we) (?:turn off|set off|drive|leave|come|head|park)\b[^,.;]*, (?=(?:is|are|how|what|can|could"
        r"|has|have|do|does)\b)",
        "",
    ),
    (r", then (?:i|we)(?:['’]ll| will| can| shall) (?:know|see|tell|decide)\b[^?.!;]*\W*$", ""),
    (
        r"(\bcount (?:the )?[\w ]+), (?:i|we) (?:must|have to|need to|want to) (?:know|be sure|make sure) (?:that|if"
        r"|whether)\b[^.;?]*\W*$",
        r"\1",
    ),
    (r",? and (?:stay|remain|wait) (?:there|put|here)\b", ""),
    (
        rf"\b({_FOLLOWING}\b[^;]*?),? while (?:(?:it|he|she) (?!is\b|was\b|has\b|does\b)\w+s"
        rf"|they (?!are\b|were\b|have\b|do\b|can\b)\w+)(?: {_WAY})*"
        rf"(?: {_WAY} (?:the|an?|his|her|its|their) [\w-]+)?(?=\s*[,.;!?]|\s*$)",
        r"\1",
    ),
    (r",? while (?:it|he|she|they) (?:taxis|walks?|drives?|moves?|goes?|works?|turns?)\b", ""),
    (r"^(?:a )?bit too (?:close|tight|far|wide|high|low)(?:,? this)?[.!,] ", ""),
    (r", who is, i (?:believe|think|fancy), [^?.;]*", ""),
    (r" than it is (?:at present|now|at the moment|currently)\b", ""),
    (
        r",? before (?:i|we|he|she|they) (?:lift|load|unload|drive|tow|launch|weld|paint|shunt|reverse)\b(?!.*\b"
        r"(?:pan|tilt|zoom)\b)[^,.;]*\W*$",
        "",
    ),
    (r"[.?!] (?:the )?[\w ]+ should be (?:over |out |down )?(?:there|here)\W*$", "."),
    (r", that (?:should|ought to|will) (?:centre|center|frame|fix|do|put|bring|show)\b[^?!,;]*\W*$", ""),
    (r"[.?!] (?:my|the|our) \w+ and i (?:have|are|were|had|want)\b[^?.]*\W*$", ""),
    (
        r"^.*\bwants? to know (?:if|whether) (?:he|she|they|we|i) should [^,.;]*[,.;] so (?=(?:please )?(?:pan|tilt"
        r"|zoom|go|take|count|turn)\b)",
        "",
    ),
    (r"^(?:g['’]day|hi|hello|hiya)?,? ?(?:just )?had (?:the|an?|my) [^?]*?, so ", ""),
    (
        r"[.?!,] (?:control|the office|the boss|they|he|she|head office) keeps? (?:on )?asking (?:me |us )?for (?:one|it|them)\W*$",
        "",
    ),
    (r",? (?:or )?till i get (?:out )?there\b", ""),
    (
        r", (?:i )?(?:always|keep|forever) (?:mix(?:ing)?|confus(?:e|ing)|get(?:ting)?|muddl(?:e|ing)) (?:up )?"
        r"(?:them|those|these|the two|those two)(?: up| wrong| the wrong way round| mixed up| confused)?\W*$",
        "",
    ),
    (r", (?:otherwise|if not,?) leave it as it is\W*$", ""),
    (
        r"\b((?:photo|picture|pic|shot|snap|still|image)s?\b.*|another(?: one)?\b.*)[,;.] (?:the |my |our )?[\w' ]{2,30}? "
        r"(?:wants?|needs?|asks? for|asked for|would like) (?:both|them both|the two|two of them|the pair)(?: of them)?\W*$",
        r"\1",
    ),
    (
        rf"\b(more than|fewer than|less than|at least|at most|over|under) ({_NUMBER})\b(.+)[;,.] \2 is (?:my|our|the) "
        r"(?:threshold|limit|cut-?off|maximum|minimum)\W*$",
        r"\1 \2\3",
    ),
    (r", can hear \w+(?: \w+)*\W*$", ""),
    (r"\bthe sky is taking up half of the picture\b", "it is too high"),
    (r",? the lower edge of the [\w ]+ is (?:just )?cut off\W*$", ""),
    (r", i (?:need|want|have) to (?:see|check|know|test) (?:if|whether) it\b[^.;?]*\W*$", ""),
    (
        r"[,.;?] (?:the |my |our )?\w+(?: \w+)? (?:wants?|needs?|would like|is asking|are asking|asks?|asked)(?: to know)? "
        r"(?:if|whether|when) (?:they|he|she|we|i) (?:can|should|may|could|need|have to|must|ought)\b[^.;?]*\W*$",
        "",
    ),
    (
        r"\b((?:forget|skip|scrap|cancel|drop|leave|leave out|never mind) (?:about )?the \w+)[,.;] "
        r"(?!(?:just|please|then|and|go|pan|tilt|zoom|take|count|find|follow|show|tell)\b)[^,.;]*\balready\b[^,.;]*\W*$",
        r"\1",
    ),
)
"""Patterns of remarks, with what is left of them."""
