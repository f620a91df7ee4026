#!/usr/bin/env perl
# A robot's mind in Perl over the wire of docs/wire.md, without a library: hthor eval --agent "cmd:perl wire_agent.pl"
# Goes ahead while the way is free, else turns; answers "Where is the mug?" when it has seen one.
use strict;
use warnings;
binmode STDIN;
binmode STDOUT;
$| = 1;

sub pack_value {    # numbers that are to be numbers are given as references
    my ($value) = @_;
    return $$value =~ /^-?\d+$/ ? pack('Cq>', 0xd3, $$value) : pack('Cd>', 0xcb, $$value) if ref $value eq 'SCALAR';
    return pack('Cn', 0xde, scalar(keys %$value)) . join('', map { pack_value($_) . pack_value($value->{$_}) } sort keys %$value)
      if ref $value eq 'HASH';
    return pack('Cn', 0xdc, scalar @$value) . join('', map { pack_value($_) } @$value) if ref $value eq 'ARRAY';
    return pack('CN/a*', 0xdb, $value);
}

sub take {    # bytes from the front
    my ($data, $size) = @_;
    return substr($$data, 0, $size, '');
}

my %sized = (0xc4 => 'C', 0xc5 => 'n', 0xc6 => 'N', 0xd9 => 'C', 0xda => 'n', 0xdb => 'N');
my %number = (0xca => 'f>', 0xcb => 'd>', 0xcc => 'C', 0xcd => 'n', 0xce => 'N', 0xcf => 'Q>', 0xd0 => 'c', 0xd1 => 's>',
    0xd2 => 'l>', 0xd3 => 'q>');
my %bytes = (C => 1, c => 1, n => 2, 's>' => 2, N => 4, 'l>' => 4, 'f>' => 4, 'd>' => 8, 'Q>' => 8, 'q>' => 8);

sub unpack_value {
    my ($data) = @_;
    my $tag = ord take($data, 1);
    return $tag if $tag < 0x80;
    return $tag - 256 if $tag >= 0xe0;
    return undef if $tag == 0xc0;
    return $tag - 0xc2 if $tag == 0xc2 || $tag == 0xc3;
    return unpack $number{$tag}, take($data, $bytes{ $number{$tag} }) if $number{$tag};
    return take($data, unpack $sized{$tag}, take($data, $bytes{ $sized{$tag} })) if $sized{$tag};
    return take($data, $tag & 31) if $tag >= 0xa0 && $tag < 0xc0;
    my $many = $tag >= 0xdc ? unpack($tag & 1 ? 'N' : 'n', take($data, $tag & 1 ? 4 : 2)) : $tag & 15;
    if ($tag >= 0xde || $tag < 0x90) {
        my %map;
        for (1 .. $many) { my $key = unpack_value($data); $map{$key} = unpack_value($data) }
        return \%map;
    }
    return [map { unpack_value($data) } 1 .. $many];
}

sub say_it { my $body = pack_value($_[0]); print pack('V/a*', $body) }

sub hear {
    read(STDIN, my $head, 4) == 4 or exit 0;
    read(STDIN, my $body, unpack 'V', $head);
    return unpack_value(\$body);
}

sub ask { say_it({ type => 'ask', what => $_[0] }); return hear()->{value} }

my %seen;    # by kind

sub answer {    # to a question that names a thing by id or kind, or only in its words
    for my $message (grep { $_->{question} } @{ $_[0] }) {
        for my $thing (map { $seen{$_} } sort keys %seen) {
            my ($object, $name) = ($message->{object}, $thing->{kind} =~ tr/_/ /r);
            next unless $object ? $object eq $thing->{id} || $object eq $thing->{kind} : index(lc $message->{text}, $name) >= 0;
            return { type => 'send', text => "I saw the $name there.", object => $thing->{id},
                position => [map { \$_ } @{ $thing->{position} }], answers => \$message->{id} };
        }
    }
    return;
}

say_it({ type => 'ready', wire => \2, name => 'perl-agent' });
while ((my $message = hear())->{type} ne 'end') {
    if ($message->{type} eq 'begin') { %seen = (); say_it({ type => 'done' }); next }
    my @ranges = unpack 'd<*', ask('scan')->{ranges}{d};
    my $free = 1;
    $_ < 0.6 and $free = 0 for @ranges[@ranges / 3 .. 2 * @ranges / 3];
    $seen{ $_->{kind} } = $_ for @{ ask('detections') };
    my $motion = $free ? { type => 'move', forward => \0.3 } : { type => 'rotate', yaw => \0.7 };
    my $say = answer($message->{observation}{inbox});
    say_it({ type => 'acted', action => { motion => $motion, ($say ? (say => $say) : ()) } });
}
